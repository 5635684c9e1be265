"""Names, units and meanings of factors and quantities: one table each, used everywhere."""

from math import pi

from solver.described import Contact, Described, Factor, Loads, Outline, on_datum, poisson, positive

#: Numeric factors of a case.
FACTORS: dict[str, Factor] = {
    "volume_fraction": Factor("1", "volume fraction of phase one", None, 0.0, high=1.0),
    "scandium_fraction": Factor("1", "scandium's share x of the metal atoms of Al(1-x)Sc(x)N", None, 0.0, high=0.5),
    "radius": positive("m", "punch radius R"),
    "radius_x": positive("m", "radius of curvature of an ellipsoid along x"),
    "radius_y": positive("m", "radius of curvature of an ellipsoid along y"),
    "length": positive("m", "length of a roller, along y"),
    "crown_radius": positive(
        "m", "radius of a roller's crown, along its axis; without one the roller is straight", optional=True
    ),
    "tilt": Factor("rad", "tilt of a roller's axis against the surface", 0.0, -1.0, high=1.0),
    "roughness": positive("m", "root mean square of a rough sphere's heights"),
    "longest_wavelength": positive("m", "longest wave of a rough sphere's heights"),
    "shortest_wavelength": positive("m", "shortest wave of a rough sphere's heights"),
    "realisation": Factor("1", "number of the random surface of a rough sphere", 0.0, 0.0),
    "map_spacing": positive("m", "distance between the points of a height map", optional=True),
    "width": positive("m", "width of a flat punch"),
    "slope": Factor("1", "slope dg/dx of a wedge's face, or tilt of a flat punch"),
    "moment": Factor("N", "moment int x p dx of the pressure about the middle of a flat punch, instead of its slope"),
    "friction": Factor("1", "Coulomb coefficient eta", 0.0, 0.0),
    "sliding_direction": Factor(
        "rad", "direction of sliding of a contact in space, from x towards y", 0.0, -2 * pi, high=2 * pi
    ),
    "load": positive("N m-1", "normal load P"),
    "charge": Factor("C m-1", "electric charge T", 0.0),
    "magnetic_charge": Factor("Wb m-1", "magnetic charge J", 0.0),
    "exponent": positive("1", "exponent of a punch's profile coefficient r^exponent"),
    "coefficient": positive("1", "coefficient of a punch's profile, lengths in m"),
    "force": positive("N", "normal force of a point contact"),
    "total_charge": Factor("C", "electric charge of the punch of a point contact", 0.0),
    "total_flux": Factor("Wb", "magnetic charge of the punch of a point contact", 0.0),
    "speed": Factor("m s-1", "steady sliding speed V", 0.0, 0.0),
    "datum": positive("m", "reference length L of the potentials", 1.0),
    "gap_permittivity": Factor(  # ferroelectric liquids have 1e4; the distance that charges spread over grows with it
        "1", "relative permittivity of what fills the gap beside the contact", 1.0, 0.0, low_allowed=False, high=1e6
    ),
    "gap_radius": positive("m", "radius at which the gap beside a point contact ends", optional=True),
    "cut_angle": Factor(
        "rad", "angle of a cut: of a rotated Y from Y towards Z, or of a tilt", None, -2 * pi, high=2 * pi
    ),
    "grid_error": Factor(
        "1", "largest relative error of a contact in space, by which its grid is refined", 5e-3, 1e-6, high=0.1
    ),
    "thickness": positive("m", "thickness of a film", optional=True),
    "base_volume_fraction": Factor(
        "1", "volume fraction of phase one at the base of a graded film", None, 0.0, high=1.0, optional=True
    ),
    "grading_exponent": Factor("1", "exponent of a graded film's depth", None, 1.0, optional=True),
    "collector": Factor("1", "number of the electrode that is read, from the top", None, 1.0),
    "patch_size": positive("m", "of the patch along x: diameter of a disc, width of a strip"),
    "patch_position": Factor("m", "of the patch's middle from that of the contact", 0.0),
    "patch_pitch": positive("m", "distance of the middles of neighbouring patches"),
    "base_modulus": positive("Pa", "Young's modulus of a film's base", optional=True),
    "base_poisson": poisson("a film's base"),
    "punch_modulus": positive("Pa", "Young's modulus of the punch", optional=True),
    "punch_poisson": poisson("the punch"),
    "touch_temperature": positive("K", "temperature of what touches the surface", optional=True),
    "body_temperature": positive("K", "temperature of the body before the touch", 293.15),
    "heat_share": positive("1", "charge of heat over that of the force at which heat_time is read", 1.0),
    "hold": positive("s", "time after the touch at which its heat is read", optional=True),
    "feedback_resistance": positive("Ohm", "resistance beside the feedback capacitance", optional=True),
    "feedback_capacitance": positive("F", "capacitance between output and input of a charge amplifier", optional=True),
}

#: The factor that states each composite's composition; the laws are those of ``solver/material/composite.py``.
COMPOSITES = {"fibrous": "volume_fraction", "laminate": "volume_fraction", "AlScN": "scandium_fraction"}

#: Chemical formula of each composite that is not a mixture, by its share and the rest.
FORMULAS = {"AlScN": "Al({rest})Sc({share})N"}

#: Composites of two phases.
MIXTURES = tuple(name for name, factor in COMPOSITES.items() if factor == "volume_fraction")

#: Factors of each profile, and its kind of contact.
PROFILES: dict[str, Outline] = {
    "cylinder": Outline(("radius",)),
    "flat": Outline(("width",), ("slope", "moment")),
    "wedge": Outline(("slope",), ("corner",)),
    "half_cylinder": Outline(("radius",), ("corner",)),
    "sphere": Outline(("radius",), contact="point"),
    "cone": Outline(("slope",), contact="point"),
    "disc": Outline(("width",), contact="point"),
    "power": Outline(("exponent", "coefficient"), contact="point"),
    "ellipsoid": Outline(("radius_x", "radius_y"), contact="point", space=True),
    "roller": Outline(("radius", "length"), ("crown_radius", "tilt"), contact="point", space=True),
    "rough_sphere": Outline(
        ("radius", "roughness", "longest_wavelength", "shortest_wavelength"),
        ("realisation",),
        contact="point",
        space=True,
    ),
    "map": Outline((), ("map_spacing",), contact="point", space=True),
}

#: Profiles of revolution that make a contact in space on a cut crystal.
ON_CUTS = ("sphere", "cone", "disc")

#: Factor of a map: a file (CSV, or one that SurfaceTopography reads), or an array of heights [m] over x and y.
HEIGHT_MAP = "height_map"

#: Factors that take one of a few names; the first is the default.
CHOICES: dict[str, tuple[str, ...]] = {
    "composite": tuple(COMPOSITES),
    "cut": ("Z", "X", "Y", "rotated Y", "tilt"),
    "profile": tuple(PROFILES),
    "corner": ("leading", "trailing"),
    "electric": ("conducting", "insulating"),
    "magnetic": ("conducting", "insulating"),
    "surroundings": ("insulated", "air"),
    "electrode": ("none", "top"),
    "patch": ("disc", "strip"),
    "interface_electric": ("grounded", "bonded"),
    "interface_magnetic": ("grounded", "bonded", "insulated"),
}

#: Factors of the electrode that is read: all of it, or a patch of it and its neighbours.
OF_AN_ELECTRODE = ("electrode", "collector", "patch", "patch_size", "patch_position", "patch_pitch")

#: Factors that name materials.
MATERIALS = ("material", "base", "punch")

#: Factors of a body's material: its name, or a composite and its share.
OF_MATERIAL = ("material", "composite", *dict.fromkeys(COMPOSITES.values()))

#: Factors of the punch's material: a name, or modulus and Poisson's ratio; without one the punch is rigid.
OF_A_PUNCH = ("punch", "punch_modulus", "punch_poisson")

#: Surroundings in which charge spreads along the punch, and their factors.
AIR, OF_A_GAP = "air", ("gap_permittivity", "gap_radius")

#: Factors of a film, a case with a thickness. Its base is named or given by modulus and Poisson's ratio.
OF_A_FILM = (
    "thickness", "base", "base_modulus", "base_poisson", "interface_electric", "interface_magnetic",
    "base_volume_fraction", "grading_exponent",
)  # fmt: skip

#: Factors of a contact in space.
OF_SPACE = ("cut", "cut_angle", "sliding_direction", "grid_error")

#: Families of cuts that need a ``cut_angle``.
ANGLED_CUTS = ("rotated Y", "tilt")

#: Factors of the heat that a touch brings to a film, and of the charge amplifier in which its charge decays.
OF_HEAT = ("touch_temperature", "body_temperature", "heat_share", "hold", "feedback_resistance", "feedback_capacitance")

#: Factor of a whole stack of layers (:class:`solver.Stack`), in place of a material and a film's factors.
BODY = "body"

#: Load and charges on the punch of each kind of contact.
CONTACTS: dict[Contact, Loads] = {
    "line": Loads("load", ("charge", "magnetic_charge")),
    "point": Loads("force", ("total_charge", "total_flux")),
}

#: Quantities of the trailing and the leading extent of a contact, equal at a point.
ENDS: dict[Contact, tuple[str, str]] = {
    "line": ("contact_trailing", "contact_leading"),
    "point": ("contact_radius", "contact_radius"),
}

#: Factors of line contacts alone: depth and potentials of a point contact are absolute, and it does not move.
OF_A_LINE = ("datum", "speed", "corner", "moment")

_OUTSIDE = (
    "of the free surface beside the contact; just inside, under a punch that conducts, sigma_xx is unbounded as the "
    "inverse square root of the distance from the edge"
)

#: Quantities, one number per case.
QUANTITIES: dict[str, Described] = {
    "contact_trailing": Described("m", "trailing extent a of the contact"),
    "contact_leading": Described("m", "leading extent b of the contact"),
    "pressure_exponent": Described("1", "pressure exponent alpha"),
    "peak_pressure": Described("Pa", "largest contact pressure"),
    "depth": on_datum("m", "indentation depth relative to the datum", on_punch=True),
    "voltage": on_datum("V", "electric potential of the punch relative to the datum"),
    "magnetic_potential": on_datum("A", "magnetic potential of the punch relative to the datum"),
    "electric_edge_intensity_trailing": Described("C m-3/2", "edge intensity of D_y at the trailing edge"),
    "electric_edge_intensity_leading": Described("C m-3/2", "edge intensity of D_y at the leading edge"),
    "magnetic_edge_intensity_trailing": Described("T m1/2", "edge intensity of B_y at the trailing edge"),
    "magnetic_edge_intensity_leading": Described("T m1/2", "edge intensity of B_y at the leading edge"),
    "trailing_tension": Described("Pa", "sigma_xx just outside the trailing edge", _OUTSIDE),
    "leading_compression": Described("Pa", "sigma_xx just outside the leading edge", _OUTSIDE),
    "voltage_per_load": on_datum("V m N-1", "d voltage / d load without charges"),
    "magnetic_potential_per_load": on_datum("A m N-1", "d magnetic potential / d load without charges"),
    "charge_per_force": on_datum("C N-1", "electric charge per load that makes the voltage 0, J = 0"),
    "flux_per_force": on_datum("Wb N-1", "magnetic charge per load that makes the magnetic potential 0, T = 0"),
    "stroke_per_volt": Described("m V-1", "depth per voltage at fixed load and magnetic charge"),
    "stroke_per_ampere": Described("m A-1", "depth per magnetic potential at fixed load and electric charge"),
    "blocked_load_per_volt": on_datum(
        "N m-1 V-1", "load per voltage at fixed depth and magnetic charge", on_punch=True
    ),
    "blocked_load_per_ampere": on_datum(
        "N m-1 A-1", "load per magnetic potential at fixed depth and electric charge", on_punch=True
    ),
}

#: For the electric and the magnetic field: potential, sensitivity, charge per load at zero potential, stroke, blocked
#: load and, on a film, capacitance or permeance.
RESPONSES = (
    ("voltage", "voltage_per_load", "charge_per_force", "stroke_per_volt", "blocked_load_per_volt",
     "capacitance_per_length"),
    ("magnetic_potential", "magnetic_potential_per_load", "flux_per_force", "stroke_per_ampere",
     "blocked_load_per_ampere", "permeance_per_length"),
)  # fmt: skip

#: Quantities of the body below depth 0.1 h, which are searched for if requested.
PEAKS: dict[str, Described] = {
    "peak_von_mises": Described("Pa", "largest von Mises stress below depth 0.1 h"),
    "peak_von_mises_depth": Described("m", "depth of the largest von Mises stress below depth 0.1 h"),
    "peak_principal_tension": Described("Pa", "largest principal stress below depth 0.1 h"),
}

#: Time [s] and temperature [K] that are reported for states of heat that are never reached.
NEVER_TIME, NEVER_TEMPERATURE = 1e6, 1e6

#: Quantities of the heat that a touch brings, of a film whose ``touch_temperature`` and ``hold`` are given.
HEAT_QUANTITIES: dict[str, Described] = {
    "heat_charge": Described("C", "charge that heat has made after hold, as far as it has not decayed"),
    "heat_charge_per_length": Described("C m-1", "the same of a contact along a line"),
    "temperature_equal": Described(
        "K",
        "rise of what touches over the body whose heat makes as much charge as the force leaves, after hold",
        f"at most {NEVER_TEMPERATURE:g} K",
    ),
    "heat_time": Described(
        "s",
        "time at which heat has made heat_share times the charge that the force leaves",
        f"at most {NEVER_TIME:g} s",
    ),
}

#: Every quantity of a half-plane.
EVERY_QUANTITY = {**QUANTITIES, **PEAKS}

#: Quantities of a film in addition to those of a half-plane.
FILM_QUANTITIES: dict[str, Described] = {
    "contact_offset": Described("m", "centre of the contact, (a - b)/2"),
    "capacitance_per_length": Described("F m-1", "d charge / d voltage at a fixed contact and magnetic charge"),
    "permeance_per_length": Described(
        "Wb A-1 m-1", "d magnetic charge / d magnetic potential at a fixed contact and charge"
    ),
    "nominal_field": Described(
        "V m-1", "abs(voltage)/thickness: the field away from the edges", formula="abs(voltage)/thickness"
    ),
}

#: Quantities of the electrode that is read, and of its patches.
ELECTRODE_QUANTITIES: dict[str, Described] = {
    "electrode_charge_per_force": Described("C N-1", "charge of the whole electrode per force"),
    "electrode_stroke_per_volt": Described(
        "m V-1", "depth per voltage of the whole electrode at fixed force and charges, all others at zero"
    ),
    "electrode_pressure": Described("Pa", "pressure on the electrode below the middle of the contact"),
    "patch_charge_per_force": Described("C N-1", "charge of a patch of the electrode at zero volts per force"),
    "crosstalk": Described("1", "charge of the neighbouring patch over that of the patch below the contact"),
    "patch_charge_gradient": Described(
        "C N-1 m-1", "change of the difference of two neighbours' charges per force, by the position between them"
    ),
}

#: Quantities of a contact whose gap carries charge, in place of edge intensities.
GAP_QUANTITIES: dict[str, Described] = {
    "capacitance_at_load": on_datum("F m-1", "d charge / d voltage at fixed load and magnetic charge"),
    "peak_displacement": Described("C m-2", "largest abs(D_y) on the contact and beside it"),
    "gap_field": Described("V m-1", "largest electric field in the gap beside the contact"),
}

#: Quantities of a film, which are searched for if requested, in place of ``PEAKS``.
FILM_PEAKS: dict[str, Described] = {
    "interface_shear": Described("Pa", "largest abs(sigma_xy) on the upper side of the interface"),
    "interface_shear_position": Described("1", "where, as (x - c)/h"),
    "interface_tension": Described("Pa", "largest sigma_yy on the upper side of the interface, 0 if none is tensile"),
    "interface_tension_position": Described("1", "where, as (x - c)/h", "NaN where none is tensile", sparse=True),
    "film_peak_von_mises": Described("Pa", "largest von Mises stress of the film below depth 0.1 h"),
    "film_peak_principal_tension": Described(
        "Pa", "largest principal stress of the film below depth 0.1 h, 0 if none is tensile"
    ),
    "base_peak_von_mises": Described("Pa", "largest von Mises stress of the base"),
    "base_peak_principal_tension": Described("Pa", "largest principal stress of the base, 0 if none is tensile"),
}

#: Every quantity of a film in addition to those of a half-plane.
EVERY_FILM_QUANTITY = {**FILM_QUANTITIES, **FILM_PEAKS}

#: Quantities of a point contact, per volt at a fixed magnetic potential, per ampere at a fixed voltage.
POINT_QUANTITIES: dict[str, Described] = {
    "contact_radius": Described("m", "radius of the contact"),
    **{name: QUANTITIES[name] for name in ("peak_pressure", "depth", "voltage", "magnetic_potential")},
    "electric_edge_intensity": Described("C m-3/2", "edge intensity of D_y around a point contact"),
    "magnetic_edge_intensity": Described("T m1/2", "edge intensity of B_y around a point contact"),
    "charge_per_force": QUANTITIES["charge_per_force"],
    "flux_per_force": QUANTITIES["flux_per_force"],
    "stroke_per_volt": QUANTITIES["stroke_per_volt"],
    "stroke_per_ampere": QUANTITIES["stroke_per_ampere"],
    "voltage_per_force": Described("V N-1", "d voltage / d force without charges"),
    "magnetic_potential_per_force": Described("A N-1", "d magnetic potential / d force without charges"),
    "blocked_force_per_volt": Described("N V-1", "force per voltage at fixed depth"),
    "blocked_force_per_ampere": Described("N A-1", "force per magnetic potential at fixed depth"),
    "capacitance": Described("F", "d charge / d voltage at a fixed contact"),
    "permeance": Described("Wb A-1", "d magnetic charge / d magnetic potential at a fixed contact"),
    "contact_stiffness": Described("N m-1", "d force / d depth at held potentials"),
    "contact_stiffness_open": Described("N m-1", "d force / d depth at fixed charges"),
}

#: Quantities of a point contact with friction, to the first order in it.
POINT_SLIDING: dict[str, Described] = {
    "contact_offset": FILM_QUANTITIES["contact_offset"],
    **{
        f"{name}_edge_intensity_{end}": QUANTITIES[f"{name}_edge_intensity_{end}"]
        for name in ("electric", "magnetic")
        for end in ("trailing", "leading")
    },
    "trailing_tension": QUANTITIES["trailing_tension"],
}

#: Quantities of a point contact whose gap carries charge, in place of edge intensities.
POINT_GAP_QUANTITIES: dict[str, Described] = {
    "capacitance_at_force": Described("F", "d charge / d voltage at fixed force and magnetic potential"),
    **{name: GAP_QUANTITIES[name] for name in ("peak_displacement", "gap_field")},
}

#: Quantities of a contact in space; those shared with a point contact have the same meaning.
SPACE_QUANTITIES: dict[str, Described] = {
    "contact_area": Described("m2", "area of the contact"),
    "contact_length_x": Described("m", "length of the contact along x"),
    "contact_length_y": Described("m", "length of the contact along y"),
    **{
        name: {**POINT_QUANTITIES, **POINT_GAP_QUANTITIES}[name]
        for name in (
            "peak_pressure", "depth", "voltage", "charge_per_force", "stroke_per_volt", "voltage_per_force",
            "blocked_force_per_volt", "capacitance", "capacitance_at_force", "contact_stiffness",
            "contact_stiffness_open",
        )
    },
    "friction_force_x": Described("N", "friction of the punch on the surface along x"),
    "friction_force_y": Described("N", "friction of the punch on the surface along y"),
    "moment_x": Described("N m", "moment of the pressure about x through the punch's middle"),
    "moment_y": Described("N m", "moment of the pressure about y through the punch's middle"),
    "moment_z": Described("N m", "moment of the friction about the normal through the punch's middle"),
    "relative_error": Described(
        "1", "largest relative error of depth, charge, voltage, stroke, capacitance and finite peak pressure"
    ),
}  # fmt: skip

#: Quantities of a contact in space that are slopes, by the solutions that they need: at other voltages, or loads too.
SPACE_SLOPES = {
    **dict.fromkeys(("stroke_per_volt", "capacitance", "capacitance_at_force"), "BY_VOLTAGE"),
    **dict.fromkeys(
        ("contact_stiffness", "contact_stiffness_open", "blocked_force_per_volt", "voltage_per_force"), "BY_LOAD"
    ),
}

#: Maps of a contact in space over (x, y), which :func:`solver.solve_map` returns.
MAPS: dict[str, Described] = {
    "contact_pressure": Described("Pa", "contact pressure -sigma_zz"),
    "electric_displacement": Described("C m-2", "normal electric displacement D_z"),
    "gap": Described("m", "gap between punch and deformed surface"),
    "contact_share": Described("1", "share of a cell that is in contact"),
}

#: Limits of a material, as far as they are known.
LIMITS: dict[str, Described] = {
    "tensile_strength": Described("Pa", "principal tension at which it breaks"),
    "yield_strength": Described("Pa", "von Mises stress at which it yields"),
    "depoling_stress": Described("Pa", "compressive stress along the poling from which the poling is lost"),
    "coercive_field": Described("V m-1", "electric field that reverses the poling"),
    "breakdown_field": Described("V m-1", "electric field at which it breaks down"),
}

#: Thermal constants of a material, as far as they are known.
THERMAL: dict[str, Described] = {
    "pyroelectric": Described(
        "C m-2 K-1",
        "change of the polarisation along the poling axis on heating, at constant stress",
        "negative where heating takes from a polarisation along +y, as that of PZT and of PVDF",
    ),
    "expansion": Described("K-1", "linear thermal expansion across the poling axis"),
    "conductivity": Described("W m-1 K-1", "thermal conductivity"),
    "heat_capacity": Described("J m-3 K-1", "heat capacity by volume"),
}

#: Quantities that each limit of the top material bounds; those of a film's base bound ``base_peak_...``.
LIMITED: dict[str, tuple[str, ...]] = {
    "tensile_strength": ("trailing_tension", "peak_principal_tension", "film_peak_principal_tension"),
    "yield_strength": ("peak_von_mises", "film_peak_von_mises"),
    "depoling_stress": ("peak_pressure",),
    "coercive_field": ("nominal_field",),
    "breakdown_field": ("nominal_field",),
}

#: Every quantity of any body.
ALL_QUANTITIES = {
    **EVERY_QUANTITY, **EVERY_FILM_QUANTITY, **GAP_QUANTITIES, **POINT_QUANTITIES, **POINT_GAP_QUANTITIES,
    **ELECTRODE_QUANTITIES, **HEAT_QUANTITIES, **SPACE_QUANTITIES,
}  # fmt: skip

#: Quantities that are searched for over a body.
ALL_PEAKS = {**PEAKS, **FILM_PEAKS}

#: Numeric factors of a film whose every value has its own tables; at other factors the tables are read.
TABLED = (
    "volume_fraction", "scandium_fraction", "friction", "speed",
    "base_modulus", "base_poisson", "base_volume_fraction", "grading_exponent", "punch_modulus", "punch_poisson",
)  # fmt: skip
