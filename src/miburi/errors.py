"""The one error that users see."""


class InputError(ValueError):
    """Something that the user gave cannot be used.

    The message is one sentence that names the file, line or key, says what was found and what was expected.
    Scripts print it and exit with 1; every other exception is a bug and keeps its traceback.
    """
