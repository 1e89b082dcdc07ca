"""The page that shows a run."""

from miburi.report.page import Corpus, Film, Picture, Section, Table, page

__all__ = ["Corpus", "Film", "Picture", "Section", "Table", "page"]
