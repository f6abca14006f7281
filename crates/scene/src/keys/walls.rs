//! Keys of `[[walls]]`.

use super::{Form, Key};
use crate::limits::{CHARGE, COORDINATE, ELECTRIC, SPEED, TIME};
use crate::tree::Range;

static PLANE: &[Key] = &[
    Key::new("point_m", Form::Vector(COORDINATE), "Point of the plane.")
        .unit("m")
        .required()
        .example("[0.0, 0.0, 0.0]")
        .also(&["point", "origin", "position", "position_m", "base_m"]),
    Key::new(
        "normal",
        Form::Vector(Range::closed(-1e100, 1e100)),
        "Direction towards the grains, of any length.",
    )
    .required()
    .example("[0.0, 0.0, 1.0]")
    .also(&["direction", "n", "axis"]),
];

static ROTATE: &[Key] = &[
    Key::new("origin_m", Form::Vector(COORDINATE), "Point of the axis.")
        .unit("m")
        .without("the origin")
        .example("[0.0, 0.0, 0.0]")
        .also(&["origin", "point_m", "centre_m", "center_m"]),
    Key::new(
        "axis",
        Form::Either(&[Form::Word(&["x", "y", "z"]), Form::Vector(Range::closed(-1e100, 1e100))]),
        "Direction of the axis; the rotation is counter-clockwise about it.",
    )
    .required()
    .example("[0.0, 1.0, 0.0]")
    .also(&["direction", "normal"]),
    Key::new("rpm", Form::Number(Range::closed(-1e6, 1e6)), "Turns in a minute.")
        .unit("1/min")
        .required()
        .example("30.0")
        .also(&["omega", "period", "period_s", "frequency_Hz", "angular_velocity_rad_s"]),
];

static VIBRATE: &[Key] = &[
    Key::new("amplitude_m", Form::Vector(COORDINATE), "Amplitude along each axis.")
        .unit("m")
        .required()
        .example("[0.0, 0.0, 1e-3]")
        .also(&["amplitude", "a"]),
    Key::new("frequency_Hz", Form::Number(Range::positive(1e9)), "Periods in a second.")
        .unit("Hz")
        .required()
        .example("50.0")
        .also(&["frequency", "period", "period_s", "omega"]),
    Key::new(
        "phase_rad",
        Form::Number(Range::closed(-1e6, 1e6)),
        "Phase at the begin, at which the wall stands where its shape puts it.",
    )
    .unit("rad")
    .without("0")
    .example("1.57")
    .also(&["phase"]),
];

static SERVO: &[Key] = &[
    Key::new(
        "force_N",
        Form::Number(Range::positive(1e15)),
        "Force of the grains against the direction that the wall holds.",
    )
    .unit("N")
    .required()
    .example("10.0")
    .also(&["force", "target", "ctrlPV"]),
    Key::new(
        "direction",
        Form::Vector(Range::closed(-1e100, 1e100)),
        "Direction in which the wall presses, of any length.",
    )
    .required()
    .example("[0.0, 0.0, -1.0]")
    .also(&["axis", "normal"]),
    Key::new("most_m_s", Form::Number(Range::positive(1e6)), "Largest speed of the wall.")
        .unit("m/s")
        .required()
        .example("0.1")
        .also(&["vel_max", "most", "speed_m_s", "max_m_s"]),
];

static MOTION: &[Key] = &[
    Key::new("rotate", Form::Table(ROTATE), "Rotation at a constant rate.")
        .without("another motion")
        .example("{ origin_m = [0.0, 0.0, 0.0], axis = [0.0, 1.0, 0.0], rpm = 30.0 }")
        .also(&["rotation", "spin"]),
    Key::new("velocity_m_s", Form::Vector(SPEED), "Translation at a constant velocity.")
        .unit("m/s")
        .without("another motion")
        .example("[0.0, 0.0, 0.1]")
        .also(&["velocity", "linear", "translate"]),
    Key::new("vibrate", Form::Table(VIBRATE), "Vibration along a line.")
        .without("another motion")
        .example("{ amplitude_m = [0.0, 0.0, 1e-3], frequency_Hz = 50.0 }")
        .also(&["wiggle", "shake", "oscillate"]),
    Key::new(
        "surface_velocity_m_s",
        Form::Vector(SPEED),
        "Velocity of a surface that slides along itself, as a belt's, while the wall stays.",
    )
    .unit("m/s")
    .without("another motion")
    .example("[0.5, 0.0, 0.0]")
    .also(&["conveyor", "surface_velocity", "surface_vel", "belt"]),
    Key::new(
        "table",
        Form::Text,
        "File of poses over time: t_s, x_m, y_m, z_m and the rotation vector rx_rad, ry_rad, rz_rad.",
    )
    .without("another motion")
    .example("\"motion.csv\"")
    .also(&["file", "csv"]),
    Key::new("origin_m", Form::Vector(COORDINATE), "Point about which a table's rotations turn.")
        .unit("m")
        .without("the origin")
        .example("[0.0, 0.0, 0.0]"),
    Key::new("servo", Form::Table(SERVO), "Press that grains bear with a given force.")
        .without("another motion")
        .example("{ force_N = 10.0, direction = [0.0, 0.0, -1.0], most_m_s = 0.1 }")
        .also(&["press", "piston"]),
    Key::new("start_s", Form::Number(Range::closed(0.0, 1e9)), "Time at which the motion begins.")
        .unit("s")
        .without("the start")
        .example("0.1")
        .also(&["start", "from_s", "begin_s"]),
    Key::new("end_s", Form::Number(TIME), "Time at which it ends; the wall stays where it came to.")
        .unit("s")
        .without("no end")
        .example("0.5")
        .also(&["end", "to_s", "stop_s"]),
];

static FLOATING: &[Key] = &[Key::new("charge_C", Form::Number(CHARGE), "Charge of the conductor.")
    .unit("C")
    .required()
    .example("0.0")
    .also(&["charge", "q"])];

static FIELD: &[Key] = &[
    Key::new("potential_V", Form::Number(ELECTRIC), "Potential of the conductor.")
        .unit("V")
        .without("a charge")
        .example("1000.0")
        .also(&["potential", "voltage", "v"]),
    Key::new("floating", Form::Table(FLOATING), "Conductor that is insulated from everything.")
        .without("a potential")
        .example("{ charge_C = 0.0 }")
        .also(&["charge_C", "insulated", "charge"]),
];

pub(super) static KEYS: &[Key] = &[
    Key::new("stl", Form::Text, "STL file with the wall's surface.")
        .without("plane, or patch")
        .example("\"hopper.stl\"")
        .also(&["file", "mesh", "obj", "geometry", "path"]),
    Key::new(
        "scale",
        Form::Number(Range::positive(1e6)),
        "Metres in a unit of the STL file; 1e-3 for millimetres.",
    )
    .default("1.0")
    .example("1e-3")
    .also(&["unit", "units", "factor"]),
    Key::new("plane", Form::Table(PLANE), "Plane without end.")
        .without("stl, or patch")
        .example("{ point_m = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }"),
    Key::new(
        "patch",
        Form::Text,
        "Patch of the solver's mesh with this surface; without stl its own faces are the wall.",
    )
    .without("a wall that the field does not know")
    .example("\"plate\""),
    Key::new("material", Form::Text, "Name of the wall's material.")
        .without("the scene's only material")
        .example("\"steel\""),
    Key::new(
        "charging",
        Form::Word(&["grounded", "insulating", "none"]),
        "How the wall takes charge at contacts: it flows off, it stays where it is, or there is none.",
    )
    .without("\"grounded\" for surfaces, \"none\" for planes")
    .example("\"insulating\"")
    .also(&["conducting", "electric"]),
    Key::new(
        "field",
        Form::Either(&[Form::Word(&["grounded", "none"]), Form::Table(FIELD)]),
        "Conductor that the stl's surface is to the field, which then ends there; or none, which the field \
         goes through.",
    )
    .default("\"none\"")
    .example("{ potential_V = 1000.0 }")
    .also(&["potential_V", "conductor", "potential", "bounds_field", "electrode", "boundary"]),
    Key::new(
        "motion",
        Form::Tables(MOTION),
        "Motions of the wall, one after another; origins and directions stay where they are in space.",
    )
    .without("a wall at rest")
    .example("[{ rotate = { axis = [0.0, 1.0, 0.0], rpm = 30.0 } }]")
    .also(&["move", "movement", "velocity_m_s", "rotate", "moving"]),
];
