//! Course of a wall: where its motions bring it, and how fast it is there.
//!
//! Both are functions of time alone, but for a servo's displacement. So a run that goes on has them bit for
//! bit, and a drum that has turned once is where it was.

use amberfield_core::{MotionKind, Placement, Vector3, WallMotion};
use amberfield_laws::cubic_table::{self, Row};
use amberfield_laws::{rotation_vector, vibration};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Times at which a table's speed is looked at between two rows.
const PER_ROW: usize = 8;
/// Times over a run at which the levers of rotations are looked at.
const LEVERS: usize = 64;

/// Motion of a wall as a rigid body, and that of its surface along itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twist {
    /// Angular velocity [rad/s].
    pub(super) spin: Vector3<f64>,
    /// Velocity of the body's point at the origin [m/s].
    pub(super) origin: Vector3<f64>,
    /// Velocity of the surface, of which what is across it does not count [m/s].
    pub(super) slide: Vector3<f64>,
}

impl Twist {
    /// Velocity of the body at a place [m/s].
    #[inline(always)]
    pub(super) fn at(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.origin + self.spin.cross(place)
    }
}

/// Place and velocity of a wall at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) placement: Placement,
    pub(super) twist: Twist,
}

/// State of a wall that is pressed on with a force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ServoState {
    /// Displacement along its direction [m].
    pub(crate) displacement: f64,
    /// Speed in the next step [m/s].
    pub(crate) speed: f64,
}

/// Motion that is ready to be followed.
#[derive(Clone, Debug)]
struct Leg {
    start_s: f64,
    end_s: f64,
    act: Act,
}

#[derive(Clone, Debug)]
enum Act {
    Rotate { origin: Vector3<f64>, axis: Vector3<f64>, turns_per_s: f64 },
    Translate(Vector3<f64>),
    Vibrate { amplitude: Vector3<f64>, frequency: f64, phase: f64 },
    Slide(Vector3<f64>),
    Table { origin: Vector3<f64>, displacement: Vec<Row>, rotation: Option<Vec<Row>> },
    Servo(Servo),
}

/// Aim of a wall that is pressed on with a force.
#[derive(Clone, Copy, Debug)]
pub(super) struct Servo {
    pub(super) force: f64,
    pub(super) direction: Vector3<f64>,
    pub(super) most: f64,
}

/// All motions of a wall, in order.
#[derive(Clone, Debug)]
pub(super) struct Course(Vec<Leg>);

impl Course {
    pub(super) fn new(motion: &[WallMotion]) -> Self {
        Self(motion.iter().map(Leg::new).collect())
    }

    /// Whether the wall ever turns.
    pub(super) fn turns(&self) -> bool {
        self.0.iter().any(|leg| match &leg.act {
            Act::Rotate { turns_per_s, .. } => *turns_per_s != 0.0,
            Act::Table { rotation, .. } => rotation.is_some(),
            _ => false,
        })
    }

    /// Servo of the wall at a time [s]; `None` outside its time, and without one.
    pub(super) fn servo(&self, time: f64) -> Option<Servo> {
        let acts = self.0.iter().filter(|leg| leg.is_active(time));
        acts.filter_map(|leg| if let Act::Servo(servo) = &leg.act { Some(*servo) } else { None }).next()
    }

    /// Place and velocity at a time [s].
    pub(super) fn at(&self, time: f64, servo: ServoState) -> Moment {
        self.first(self.0.len(), time, servo)
    }

    /// Place and velocity at a time [s] by the first of the motions alone.
    fn first(&self, count: usize, time: f64, servo: ServoState) -> Moment {
        let zero = Vector3::zeros();
        let rest = Twist { spin: zero, origin: zero, slide: zero };
        let start = Moment { placement: Placement::home(), twist: rest };
        self.0[..count].iter().fold(start, |moment, leg| leg.act_on(moment, time, servo))
    }

    /// Bound on the speed of the wall at some `corners` [m] that hold it, until a time [s].
    pub(super) fn fastest(&self, corners: &[Vector3<f64>; 8], end_s: f64) -> f64 {
        let speeds: Vec<f64> = (0..self.0.len()).map(|leg| self.speed_of(leg, corners, end_s)).collect();
        let mut times: Vec<f64> = self.0.iter().flat_map(|leg| [leg.start_s, leg.end_s]).collect();
        times.retain(|time| *time < end_s);
        times.push(0.0);
        let at = |time: &f64| {
            let active = self.0.iter().zip(&speeds).filter(|(leg, _)| leg.is_active(*time));
            active.map(|(_, speed)| speed).sum::<f64>()
        };
        times.iter().map(at).fold(0.0, f64::max)
    }

    /// Bound on the speed that one of the motions adds.
    fn speed_of(&self, leg: usize, corners: &[Vector3<f64>; 8], end_s: f64) -> f64 {
        // Distance of the corners from the axis of a rotation, over the run.
        let lever = |origin: &Vector3<f64>, axis: Option<&Vector3<f64>>| {
            let at = |k: usize| {
                let time = end_s * k as f64 / LEVERS as f64;
                let placement = self.first(leg, time, ServoState::default()).placement;
                let arms = corners.iter().map(|corner| placement.place(corner) - origin);
                arms.map(|arm| axis.map_or(arm.norm(), |axis| axis.cross(&arm).norm())).fold(0.0, f64::max)
            };
            (0..=LEVERS).map(at).fold(0.0, f64::max)
        };
        match &self.0[leg].act {
            Act::Rotate { origin, axis, turns_per_s } => TAU * turns_per_s.abs() * lever(origin, Some(axis)),
            Act::Translate(velocity) => velocity.norm(),
            Act::Vibrate { amplitude, frequency, .. } => TAU * frequency * amplitude.norm(),
            Act::Slide(_) => 0.0,
            Act::Table { origin, displacement, rotation } => {
                let turning = rotation.as_ref().map_or(0.0, |rotation| fastest_in(rotation));
                let arm = if turning > 0.0 { lever(origin, None) } else { 0.0 };
                fastest_in(displacement) + turning * arm
            }
            Act::Servo(servo) => servo.most,
        }
    }
}

/// Largest rate of a table.
fn fastest_in(rows: &[Row]) -> f64 {
    let between = |pair: &[Row]| {
        let at = |k: usize| pair[0].time + (pair[1].time - pair[0].time) * k as f64 / PER_ROW as f64;
        (0..PER_ROW).map(|k| cubic_table::between(rows, at(k)).rate.norm()).fold(0.0, f64::max)
    };
    rows.windows(2).map(between).fold(0.0, f64::max)
}

impl Leg {
    fn new(motion: &WallMotion) -> Self {
        let act = match motion.kind.clone() {
            MotionKind::Rotate { origin, axis, turns_per_s } => Act::Rotate { origin, axis, turns_per_s },
            MotionKind::Translate(velocity) => Act::Translate(velocity),
            MotionKind::Vibrate { amplitude, frequency_hz: frequency, phase } => {
                Act::Vibrate { amplitude, frequency, phase }
            }
            MotionKind::Slide(velocity) => Act::Slide(velocity),
            MotionKind::Table { origin, rows } => {
                let turns = rows.iter().any(|row| row.rotation != Vector3::zeros());
                let displaced = rows.iter().map(|row| Row { time: row.time_s, value: row.displacement });
                let turned = rows.iter().map(|row| Row { time: row.time_s, value: row.rotation });
                Act::Table {
                    origin,
                    displacement: displaced.collect(),
                    rotation: turns.then(|| turned.collect()),
                }
            }
            MotionKind::Servo { force_n: force, direction, most_m_s: most } => {
                Act::Servo(Servo { force, direction, most })
            }
            // A kind that is new in the core is new here too.
            _ => Act::Translate(Vector3::zeros()),
        };
        Self { start_s: motion.start_s, end_s: motion.end_s, act }
    }

    fn is_active(&self, time: f64) -> bool {
        self.start_s <= time && time < self.end_s
    }

    /// Adds the motion to what those before it have done.
    fn act_on(&self, before: Moment, time: f64, servo: ServoState) -> Moment {
        let since = time.clamp(self.start_s, self.end_s) - self.start_s;
        let is_active = self.is_active(time);
        match &self.act {
            Act::Rotate { origin, axis, turns_per_s } => {
                if *turns_per_s == 0.0 {
                    return before;
                }
                let turn = rotation_vector::about(axis, turns_per_s * since);
                let placement = Placement { turn, shift: origin - turn * origin };
                let rate = if is_active { TAU * turns_per_s } else { 0.0 };
                let spin = axis * rate;
                turned(before, &placement, spin, origin.cross(&spin))
            }
            Act::Translate(velocity) => shifted(before, velocity * since, velocity, is_active),
            Act::Vibrate { amplitude, frequency, phase } => {
                let displacement = amplitude * vibration::displacement(*frequency, *phase, since);
                let velocity = amplitude * vibration::rate(*frequency, *phase, since);
                shifted(before, displacement, &velocity, is_active)
            }
            Act::Slide(velocity) => {
                let mut after = before;
                if is_active {
                    after.twist.slide += velocity;
                }
                after
            }
            Act::Table { origin, displacement, rotation } => {
                let moved = cubic_table::between(displacement, since);
                let Some(rotation) = rotation else {
                    return shifted(before, moved.value, &moved.rate, is_active);
                };
                let angles = cubic_table::between(rotation, since);
                let turn = rotation_vector::matrix(&angles.value);
                let placement = Placement { turn, shift: origin + moved.value - turn * origin };
                let mut spin = rotation_vector::angular_velocity(&angles.value, &angles.rate);
                let mut velocity = moved.rate;
                if !is_active {
                    (spin, velocity) = (Vector3::zeros(), Vector3::zeros());
                }
                turned(before, &placement, spin, velocity - spin.cross(&(origin + moved.value)))
            }
            Act::Servo(Servo { direction, .. }) => {
                let velocity = direction * servo.speed;
                shifted(before, direction * servo.displacement, &velocity, is_active)
            }
        }
    }
}

/// Adds a translation.
fn shifted(before: Moment, shift: Vector3<f64>, velocity: &Vector3<f64>, is_active: bool) -> Moment {
    let Moment { mut placement, mut twist } = before;
    placement.shift += shift;
    // The point that is at the origin now was elsewhere.
    twist.origin -= twist.spin.cross(&shift);
    if is_active {
        twist.origin += velocity;
    }
    Moment { placement, twist }
}

/// Adds a rotation, with its own angular velocity and its velocity at the origin.
fn turned(before: Moment, by: &Placement, spin: Vector3<f64>, origin: Vector3<f64>) -> Moment {
    let Moment { placement, twist } = before;
    let carried = by.turn * twist.spin;
    Moment {
        placement: Placement { turn: by.turn * placement.turn, shift: by.place(&placement.shift) },
        twist: Twist {
            spin: spin + carried,
            origin: origin + by.turn * twist.origin - carried.cross(&by.shift),
            slide: by.turn * twist.slide,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(kinds: Vec<MotionKind>) -> Course {
        let whole = |kind| WallMotion { kind, start_s: 0.0, end_s: f64::INFINITY };
        Course::new(&kinds.into_iter().map(whole).collect::<Vec<_>>())
    }

    fn table() -> MotionKind {
        let row = |t: f64| amberfield_core::MotionRow {
            time_s: t,
            displacement: Vector3::new(t * t, -t, 0.3 * t),
            rotation: Vector3::new(0.4 * t, t * t, -0.2),
        };
        MotionKind::Table {
            origin: Vector3::new(0.2, -0.1, 0.4),
            rows: [0.0, 0.5, 1.1, 2.0].map(row).to_vec(),
        }
    }

    fn rotate(turns_per_s: f64) -> MotionKind {
        let (origin, axis) = (Vector3::new(0.3, 1.0, -0.5), Vector3::new(0.36, 0.48, 0.8));
        MotionKind::Rotate { origin, axis, turns_per_s }
    }

    #[test]
    fn velocity_is_the_derivative_of_the_place() {
        let course = all(vec![
            MotionKind::Vibrate { amplitude: Vector3::new(0.1, 0.0, 0.2), frequency_hz: 1.3, phase: 0.4 },
            rotate(0.7),
            MotionKind::Translate(Vector3::new(0.1, -0.2, 0.3)),
            table(),
            rotate(-0.2),
        ]);
        let (h, point) = (1e-6, Vector3::new(0.7, -0.4, 0.1));
        let place = |time: f64| course.at(time, ServoState::default()).placement.place(&point);
        for time in [0.2, 0.77, 1.5] {
            let slope = (place(time + h) - place(time - h)) / (2.0 * h);
            let velocity = course.at(time, ServoState::default()).twist.at(&place(time));
            assert!((slope - velocity).norm() < 1e-7, "{time}: {slope} {velocity}");
        }
    }

    #[test]
    fn whole_turns_and_what_has_ended_leave_the_wall_where_it_was() {
        let at = |course: &Course, time: f64| course.at(time, ServoState::default());
        let drum = all(vec![rotate(0.5)]);
        assert_eq!(at(&drum, 4.0).placement, Placement::home());
        let short = WallMotion { kind: rotate(0.5), start_s: 1.0, end_s: 3.0 };
        let course = Course::new(&[short]);
        assert_eq!(at(&course, 0.5).placement, Placement::home());
        assert_eq!(at(&course, 7.5).placement, Placement::home());
        assert_eq!(at(&course, 7.5).twist.spin, Vector3::zeros());
    }

    #[test]
    fn bound_on_the_speed_holds() {
        let corners = [1.0, -0.5, 0.3, 0.8, -1.0, 0.1, 0.6, -0.2].map(|x| Vector3::new(x, x * x, -x));
        let course = all(vec![table(), rotate(0.7)]);
        let bound = course.fastest(&corners, 2.0);
        for k in 0..500 {
            let Moment { placement, twist } = course.at(0.004 * f64::from(k), ServoState::default());
            for corner in &corners {
                assert!(twist.at(&placement.place(corner)).norm() < bound * 1.05);
            }
        }
        assert_eq!(all(vec![MotionKind::Slide(Vector3::x())]).fastest(&corners, 1.0), 0.0);
    }
}
