//! Checks of the motion of walls in a set-up.

use amberfield_core::{Axis, Domain, MotionKind, Vector3, Wall, WallCharging, WallMotion};

/// Largest difference of a direction's length from 1.
const UNIT: f64 = 1e-9;

/// Refuses motions that cannot be followed in a box; `trades` says whether contacts move charge. `Err` says
/// what is wrong.
pub(super) fn check(wall: &Wall, domain: &Domain, trades: bool) -> Result<(), String> {
    let bad = |text: &str| Err(format!("wall '{}': {text}", wall.name));
    let carries = trades && wall.charging == WallCharging::Insulating;
    if carries && wall.motion.iter().any(|motion| !keeps_periods(motion, domain)) {
        return bad(
            "it takes its charge along and turns across a periodic axis, where its periodic copies turn \
             elsewhere; make the axis open, or the wall's charging \"none\" or \"grounded\"",
        );
    }
    let servos = wall.motion.iter().filter(|motion| matches!(motion.kind, MotionKind::Servo { .. }));
    if servos.count() > 1 {
        return bad("it has two servos, of which neither would know the other; give one");
    }
    match wall.motion.iter().find_map(fault) {
        Some(text) => bad(text),
        None => Ok(()),
    }
}

/// Whether what moves along has its periodic copies a period away all the time.
fn keeps_periods(motion: &WallMotion, domain: &Domain) -> bool {
    let periodic = || Axis::ALL.into_iter().filter(|axis| domain.is_periodic(*axis));
    match &motion.kind {
        MotionKind::Rotate { axis, .. } => {
            let off = |period: Axis| axis.cross(&Vector3::ith(period.index(), 1.0)).norm();
            periodic().all(|period| off(period) < UNIT)
        }
        MotionKind::Table { rows, .. } => {
            periodic().next().is_none() || rows.iter().all(|row| row.rotation.norm() == 0.0)
        }
        _ => true,
    }
}

/// Fault of a motion; `None` of a good one.
fn fault(motion: &WallMotion) -> Option<&'static str> {
    let finite = |vector: &Vector3<f64>| vector.iter().all(|x| x.is_finite());
    let unit = |vector: &Vector3<f64>| (vector.norm() - 1.0).abs() <= UNIT;
    // `!(a < b)`: what is not a number is wrong too.
    let lasts = motion.start_s.is_finite() && motion.start_s < motion.end_s;
    if !lasts {
        return Some("a motion ends before it begins; give an end after the start");
    }
    match &motion.kind {
        MotionKind::Rotate { origin, axis, turns_per_s } => {
            (!(finite(origin) && unit(axis) && turns_per_s.is_finite()))
                .then_some("a rotation needs a finite origin and rate and a unit vector as axis")
        }
        MotionKind::Translate(velocity) | MotionKind::Slide(velocity) => {
            (!finite(velocity)).then_some("a velocity must be finite")
        }
        MotionKind::Vibrate { amplitude, frequency_hz, phase } => {
            (!(finite(amplitude) && frequency_hz.is_finite() && *frequency_hz >= 0.0 && phase.is_finite()))
                .then_some("a vibration needs a finite amplitude and phase and a frequency of 0 or more")
        }
        MotionKind::Table { origin, rows } => {
            let rises = rows.len() > 1 && rows.is_sorted_by(|a, b| a.time_s < b.time_s);
            let known = rows.iter().all(|row| finite(&row.displacement) && finite(&row.rotation));
            (!(rises && known && finite(origin)))
                .then_some("a table needs two rows at least, finite numbers and times that rise")
        }
        MotionKind::Servo { force_n, direction, most_m_s } => {
            let positive = |x: f64| x.is_finite() && x > 0.0;
            (!(positive(*force_n) && positive(*most_m_s) && unit(direction)))
                .then_some("a servo needs a force and a largest speed above 0 and a unit vector as direction")
        }
        _ => Some("a motion of this kind is not known here"),
    }
}
