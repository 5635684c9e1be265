"""Titles of names on pages and in messages, old names of quantities, and words for how a source is known."""

import re

#: Titles of names that need other words than their own.
TITLES = {
    "electric": "punch (electric)",
    "magnetic": "punch (magnetic)",
    "interface_electric": "interface (electric)",
    "interface_magnetic": "interface (magnetic)",
    "volume_fraction": "volume fraction",
    "contact_trailing": "trailing extent of the contact",
    "contact_leading": "leading extent of the contact",
    "trailing_tension": "tension behind the contact",
    "leading_compression": "stress ahead of the contact",
    "peak_pressure": "contact pressure",
    "capacitance_per_length": "capacitance",
    "permeance_per_length": "permeance",
    "nominal_field": "electric field over the thickness",
    "peak_von_mises": "von Mises stress in the body",
    "peak_principal_tension": "tension in the body",
    "film_peak_von_mises": "von Mises stress in the film",
    "film_peak_principal_tension": "tension in the film",
    "interface_shear": "shear of the interface",
    "interface_tension": "tension of the interface",
    "smallest_force": "smallest detectable force",
    "drive_field": "driving field",
    "electric_displacement_y": "normal electric displacement",
    "magnetic_induction_y": "normal magnetic induction",
    "electric_displacement_x": "tangential electric displacement",
    "magnetic_induction_x": "tangential magnetic induction",
    "electric_displacement": "normal electric displacement",
    "magnetic_induction": "normal magnetic induction",
    "stress_xx": "stress along the surface",
}

#: The present name of every old one. An old name that is a present one of the contact at hand stays what it is.
RENAMED = {
    "voltage_sensitivity": "voltage_per_load",
    "magnetic_sensitivity": "magnetic_potential_per_load",
    "charge_sensitivity": "charge_per_force",
    "flux_sensitivity": "flux_per_force",
    "capacitance": "capacitance_per_length",
    "permeance": "permeance_per_length",
    "contact_capacitance": "capacitance",
    "contact_permeance": "permeance",
    "contact_capacitance_at_force": "capacitance_at_force",
}
_NOT_READ = re.compile(r"\b(recalled|not read|somebody's code)\b")  # words of sources
_YEAR = re.compile(r"\b(19|20)\d\d\b")
_FORMULA = tuple("=+-@\t\r")  # with which a spreadsheet begins to calculate


def unverified(source: str) -> str:
    """Return a mark for a source that says that it was not read, or that has no year; empty for others."""
    if _NOT_READ.search(source):
        return " (unverified: not read at its source)"
    return "" if _YEAR.search(source) else " (unverified: no dated source)"


def plain(cell: object) -> object:
    """Return a cell of CSV with an apostrophe before a text that a spreadsheet would calculate."""
    return f"'{cell}" if isinstance(cell, str) and cell[:1] in _FORMULA else cell
