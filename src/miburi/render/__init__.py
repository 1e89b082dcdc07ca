"""Pictures: films and contact sheets by OpenGL, plots by matplotlib."""
