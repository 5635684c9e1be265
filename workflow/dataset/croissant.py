"""The data card as Croissant: metadata of a data set that programs of machine learning read (MLCommons, version 1.1).

What a field of a record is stands in Croissant's own words, sizes included; unit, range, mean and standard deviation of
every variable stand in schema.org's `variableMeasured`, which search engines of data read.
"""

from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import Any

from storage.described import LICENSE
from workflow.language.factors import FACTORS

_WORDS = (
    "arrayShape citeAs column containedIn equivalentProperty extract field fileProperty fileObject fileSet "
    "format includes isArray isLiveDataset jsonPath key md5 parentField path recordSet references regex "
    "repeated replace samplingRate separator source subField transform"
)
_CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "sc": "https://schema.org/",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "dct": "http://purl.org/dc/terms/",
    "conformsTo": "dct:conformsTo",
    "name": {"@container": "@language"},
    "description": {"@container": "@language"},
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "examples": {"@id": "cr:examples", "@type": "@json"},
    **{word: f"cr:{word}" for word in _WORDS.split()},
}
_PAPER = (
    "Elloumi, R., Kallel-Kamoun, I., El-Borgi, S., Guler, M. A.: On the frictional sliding contact problem between a "
    "rigid circular conducting punch and a magneto-electro-elastic half-plane. Int. J. Mech. Sci., 2014"
)
_NETCDF = "application/x-netcdf"


def croissant(card: Mapping[str, Any]) -> dict[str, Any]:
    """Metadata of a data set as JSON-LD."""
    files = [_file(file) for file in card["files"]]
    slabs = {"@type": "cr:FileSet", "@id": "slabs", "name": "slabs", "includes": "fields/slab_*.nc"}
    axes = [_field(name, *_axis(name, name in card["categories"])) for name in (*card["factors"], *card["categories"])]
    outputs = [_output(name, variable, card) for name, variable in card["variables"].items()]
    key = [{"@id": axis["@id"]} for axis in axes]
    return {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.1",
        "name": card["study"],
        "description": f"{card['title']} {card['cases']:,} exact cases{_at(card['positions'])}.",
        "version": version("meecontact"),
        "license": LICENSE,
        "citeAs": _PAPER,
        "distribution": [*files, slabs | {"encodingFormat": _NETCDF}],
        "recordSet": [{"@type": "cr:RecordSet", "@id": "cases", "name": "cases", "key": key, "field": axes + outputs}],
        "variableMeasured": [_measured(name, variable) for name, variable in card["variables"].items()],
    }


def _at(positions: Sequence[float]) -> str:
    return f", each at {len(positions)} positions" if positions else ""


def _file(file: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "@type": "cr:FileObject",
        "@id": file["name"],
        "name": file["name"],
        "contentUrl": file["name"],
        "contentSize": f"{file['bytes']} B",
        "encodingFormat": _NETCDF,
        "sha256": file["sha256"],
    }


def _field(name: str, description: str, kind: str) -> dict[str, Any]:
    return {
        "@type": "cr:Field",
        "@id": f"cases/{name}",
        "name": name,
        "description": description,
        "dataType": kind,
        "source": {"fileSet": {"@id": "slabs"}, "extract": {"column": name}},
    }


def _axis(name: str, category: bool) -> tuple[str, str]:
    """Return the meaning and type of an axis of the factorial."""
    if category:
        return f"{name} of the case", "sc:Text"
    return f"{FACTORS[name].long_name}, in {FACTORS[name].units}", "sc:Float"


def _output(name: str, variable: Mapping[str, Any], card: Mapping[str, Any]) -> dict[str, Any]:
    """A field of every case: a number, or an array over the positions."""
    attrs = variable["attributes"]
    field = _field(name, f"{attrs['long_name']}, in {attrs['units']}", "sc:Float")
    return field | (
        {"isArray": True, "arrayShape": str(variable["count"] // card["cases"])}
        if variable["count"] > card["cases"]
        else {}
    )


def _measured(name: str, variable: Mapping[str, Any]) -> dict[str, Any]:
    attrs = variable["attributes"]
    low, high = attrs["actual_range"]
    return {
        "@type": "PropertyValue",
        "name": name,
        "description": f"{attrs['long_name']}; mean {attrs['mean']:g}, deviation {attrs['standard_deviation']:g}",
        "unitText": attrs["units"],
        "minValue": low,
        "maxValue": high,
    }
