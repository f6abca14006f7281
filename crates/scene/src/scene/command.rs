//! Command form of `[electric_field]`: one line of words.
//!
//! Example: `enable_electric_field field_cutoff_radius 3e-3 enable_collision_charge_transfer yes`

use super::description::ElectricFieldSettings;
use crate::SceneError;
use crate::error::shorten;
use crate::tree::{Entries, Node, Value, nearest};
use amberfield_core::{CouplingInterval, Course, FieldSettings, Method, Tuning};
use nalgebra::Vector3;
use std::fmt::Write as _;

/// First word of the command.
const COMMAND: &str = "enable_electric_field";

/// Kind of the value that follows a key.
#[derive(Clone, Copy, Debug)]
pub(super) enum KeyKind {
    /// Single word.
    Word,
    /// Number.
    Number,
    /// Word `yes` or `no`.
    YesNo,
}

/// Keys that the command and the section share.
pub(super) const COMMAND_KEYS: [(&str, KeyKind); 9] = [
    ("id", KeyKind::Word),
    ("particle_group", KeyKind::Word),
    ("field_cutoff_radius", KeyKind::Number),
    ("use_without_cfd_coupling", KeyKind::YesNo),
    ("enable_collision_charge_transfer", KeyKind::YesNo),
    ("charge_transfer_cutoff", KeyKind::Number),
    ("limit_field_force", KeyKind::YesNo),
    ("field_force_limit_factor", KeyKind::Number),
    ("relative_permittivity", KeyKind::Number),
];

/// Translates the command's keys and values into entries of `[electric_field]`.
///
/// # Errors
/// Other commands, unknown keys, keys given twice or without a value, and a missing cut-off radius.
pub(super) fn command_entries(command: &str, node: &Node) -> Result<Entries, SceneError> {
    let bad = |value: &str, problem: String| SceneError::Value {
        place: node.place.to_string(),
        key: "electric_field.command".to_owned(),
        value: format!("\"{}\"", shorten(value)),
        problem,
    };
    let mut words = command.split_whitespace();
    match words.next() {
        Some(COMMAND) => {}
        other => {
            return Err(bad(other.unwrap_or(command), format!("the command starts with {COMMAND}")));
        }
    }
    let names = COMMAND_KEYS.map(|(key, _)| key);
    let mut entries = Entries::new();
    while let Some(key) = words.next() {
        let Some((_, kind)) = COMMAND_KEYS.iter().find(|(name, _)| *name == key) else {
            let advice = match nearest(key, &names) {
                _ if key == COMMAND => "; the electric field can be enabled only once".to_owned(),
                Some(near) => format!("; the nearest known key is {near}"),
                None => String::new(),
            };
            return Err(bad(key, format!("unknown key of the command{advice}")));
        };
        if entries.iter().any(|(name, _)| name == key) {
            return Err(bad(key, "given twice in the command; keep one".to_owned()));
        }
        let Some(word) = words.next() else {
            return Err(bad(key, "the key has no value; add one after it".to_owned()));
        };
        let value = match kind {
            KeyKind::Word => Value::Text(word.to_owned()),
            KeyKind::Number => Value::Float(
                word.parse().map_err(|_| bad(word, format!("{key} needs a number, such as 3e-3")))?,
            ),
            KeyKind::YesNo => match word {
                "yes" => Value::Boolean(true),
                "no" => Value::Boolean(false),
                _ => return Err(bad(word, format!("{key} needs yes or no"))),
            },
        };
        entries.push((key.to_owned(), Node { value, place: node.place.clone() }));
    }
    if entries.iter().any(|(key, _)| key == "field_cutoff_radius") {
        Ok(entries)
    } else {
        Err(bad(command, "the command needs field_cutoff_radius; add it in metres".to_owned()))
    }
}

/// Text of the external field.
fn external_field(field: &FieldSettings) -> String {
    let vector = |v: Vector3<f64>| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    match &field.external_course {
        None => vector(field.external_field_v_m),
        Some(Course::Sine { amplitude, frequency_hz, phase, offset }) => format!(
            "{{ amplitude = {}, frequency_Hz = {frequency_hz:?}, phase_rad = {phase:?}, offset = {} }}",
            vector(*amplitude),
            vector(*offset)
        ),
        Some(Course::Table { name, .. }) => {
            format!("{{ table = {} }}", toml::Value::String(name.clone()))
        }
        Some(other) => format!("{other:?}"),
    }
}

impl ElectricFieldSettings {
    /// Text of the settings as a section of a scene, with every key written out.
    #[must_use]
    pub fn as_section(&self) -> String {
        let field = &self.field;
        let mut text = String::from("[electric_field]\n");
        let mut line = |key: &str, value: String| {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{key} = {value}");
        };
        let quoted = |word: &str| toml::Value::String(word.to_owned()).to_string();
        let auto = || "\"auto\"".to_owned();
        line("method", quoted(field.method.name()));
        line("tolerance", format!("{:?}", field.tolerance));
        if let Some(radius) = field.cutoff_radius_m {
            line("field_cutoff_radius", format!("{radius:?}"));
        }
        line("id", quoted(&self.id));
        line("particle_group", quoted(&self.particle_group));
        line("use_without_cfd_coupling", self.use_without_cfd_coupling.to_string());
        line("enable_collision_charge_transfer", self.enable_collision_charge_transfer.to_string());
        line("charge_transfer_cutoff", format!("{:?}", self.charge_transfer_cutoff_m));
        line("limit_field_force", self.limit_field_force.to_string());
        line("field_force_limit_factor", format!("{:?}", self.field_force_limit_factor));
        line("relative_permittivity", format!("{:?}", field.permittivity.relative()));
        line("external_field_V_m", external_field(field));
        line(
            "coupling_interval",
            match field.coupling_interval {
                CouplingInterval::Auto => auto(),
                CouplingInterval::Steps(steps) => steps.to_string(),
            },
        );
        line("overlap", self.field.overlap.to_string());
        line("tuning", quoted(if field.tuning == Tuning::Timed { "timed" } else { "model" }));
        line("far_tolerance", self.far_tolerance.map_or_else(auto, |tolerance| format!("{tolerance:?}")));
        line("neutralising_background", field.neutralising_background.to_string());
        let cells = field.grid_cells.map_or_else(auto, |cells| format!("{cells:?}"));
        line("grid", format!("{{ cells = {cells} }}"));
        text
    }

    /// Text of the settings as a section with the one-line command.
    ///
    /// # Errors
    /// The reason why the command cannot express them: no cut-off radius, or a key that the command lacks.
    pub fn as_command(&self) -> Result<String, String> {
        let field = &self.field;
        let radius = field.cutoff_radius_m.ok_or("the command needs field_cutoff_radius")?;
        let plain = FieldSettings::default();
        for (key, differs) in [
            (
                "external_field_V_m",
                field.external_field_v_m != Vector3::zeros() || field.external_course.is_some(),
            ),
            ("coupling_interval", field.coupling_interval != CouplingInterval::Auto),
            ("overlap", self.field.overlap),
            ("tuning", field.tuning != plain.tuning),
            ("far_tolerance", self.far_tolerance.is_some()),
            ("neutralising_background", field.neutralising_background),
            ("grid", field.grid_cells.is_some()),
        ] {
            if differs {
                return Err(format!("{key} has no place in the command"));
            }
        }
        for (key, word) in [("id", &self.id), ("particle_group", &self.particle_group)] {
            if word.chars().any(|c| c.is_whitespace() || c == '"' || c == '\\' || c.is_control()) {
                return Err(format!("{key} \"{}\" is not one plain word", shorten(word)));
            }
        }
        let yes_no = |flag: bool| if flag { "yes" } else { "no" };
        let mut text = String::from("[electric_field]\n");
        if field.method != Method::default() {
            let _ = writeln!(text, "method = \"{}\"", field.method);
        }
        if field.tolerance != plain.tolerance {
            let _ = writeln!(text, "tolerance = {:?}", field.tolerance);
        }
        let _ = writeln!(
            text,
            "command = \"{COMMAND} id {} particle_group {} field_cutoff_radius {radius:?} \
             use_without_cfd_coupling {} enable_collision_charge_transfer {} \
             charge_transfer_cutoff {:?} limit_field_force {} field_force_limit_factor {:?} \
             relative_permittivity {:?}\"",
            self.id,
            self.particle_group,
            yes_no(self.use_without_cfd_coupling),
            yes_no(self.enable_collision_charge_transfer),
            self.charge_transfer_cutoff_m,
            yes_no(self.limit_field_force),
            self.field_force_limit_factor,
            field.permittivity.relative(),
        );
        Ok(text)
    }
}
