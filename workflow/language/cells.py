"""Cells of tables that a spreadsheet opens: a text that it would calculate stays a text."""

_FORMULA = tuple("=+-@\t\r")  # with which a spreadsheet begins to calculate


def plain(cell: object) -> object:
    """A cell of CSV: a text that a spreadsheet would calculate stands behind an apostrophe."""
    return f"'{cell}" if isinstance(cell, str) and cell[:1] in _FORMULA else cell
