//! Walls that move: their triangles and planes at the present time, their velocity at contacts, their work.
//!
//! Lists know walls at the time at which they were built. Between two lists only the triangles near grains
//! are moved, and the lists are built anew before a wall has used up its share of the skin. Along periodic
//! axes a wall is taken back by whole periods, when lists are built.

use super::course::{Course, Moment, ServoState, Twist};
use super::parts::Part;
use super::surfaces::{Facet, Plane, Surfaces};
use crate::contacts::law::{Contact, History};
use amberfield_core::{Axis, Domain, Matrix3, Placement, Vector3, Wall, WallShape};
use amberfield_laws::servo;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// State of the walls that move, for checkpoints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MoversState {
    bodies: Vec<MoverState>,
    /// Work of the walls on the grains since the start [J].
    work: f64,
    /// Power at the last evaluation [W].
    power: f64,
}

/// State of a wall that moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct MoverState {
    /// Place for which the lists were built.
    listed: Placement,
    /// Periods by which it was taken back [m].
    fold: Vector3<f64>,
    servo: ServoState,
}

/// Shape of a wall where its file puts it.
#[derive(Debug)]
enum Home {
    /// Triangles that are numbered from the first.
    Mesh { first: u32, facets: Vec<Facet> },
    /// Plane of a number.
    Plane { number: u32, plane: Plane },
}

/// Wall that moves.
#[derive(Debug)]
pub(super) struct Mover {
    course: Course,
    turns: bool,
    home: Home,
    /// Corners of the box that holds the wall at home, or for a plane of the domain [m].
    corners: [Vector3<f64>; 8],
    /// Place now.
    placement: Placement,
    /// Rotation of the last step.
    turn: Matrix3<f64>,
    /// Velocity in the middle of the last step, and at its end.
    middle: Twist,
    end: Twist,
    /// Triangles near grains, ascending.
    near: Vec<u32>,
    state: MoverState,
    /// Number of the wall in the scene.
    wall: u32,
}

/// All walls that move.
#[derive(Debug)]
pub(crate) struct Movers {
    bodies: Vec<Mover>,
    /// Body of each surface.
    of_surface: Vec<Option<u32>>,
    work: f64,
    power: f64,
    /// Largest way by which walls stand out of the domain along periodic axes [m].
    pub(super) outside: Vector3<f64>,
    /// Marks of triangles.
    marked: Vec<bool>,
}

/// Velocity of a wall at a contact, at the end of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    /// Velocity at the contact, with the sliding of the surface [m/s].
    pub(super) contact: Vector3<f64>,
    /// Velocity at the grain's centre, as if the wall reached there [m/s].
    pub(super) centre: Vector3<f64>,
    /// Angular velocity [rad/s].
    pub(super) spin: Vector3<f64>,
}

impl Movers {
    /// Walls that move; `None` where all are at rest.
    pub(super) fn new(walls: &[Wall], parts: &[Part], surfaces: &Surfaces, domain: &Domain) -> Option<Self> {
        let (mut bodies, mut of_surface) = (Vec::new(), Vec::new());
        for (surface, part) in parts.iter().enumerate() {
            let wall = &walls[part.wall as usize];
            of_surface.push((!wall.motion.is_empty()).then_some(bodies.len() as u32));
            if !wall.motion.is_empty() {
                bodies.push(Mover::new(wall, part.wall, surfaces.numbers_of(surface), surfaces, domain));
            }
        }
        let marked = vec![false; surfaces.len()];
        let outside = Vector3::zeros();
        (!bodies.is_empty()).then_some(Self { bodies, of_surface, work: 0.0, power: 0.0, outside, marked })
    }

    /// Moves to a time [s], after a step [s].
    pub(super) fn advance(&mut self, surfaces: &mut Surfaces, time: f64, step: f64) {
        for body in &mut self.bodies {
            body.advance(time, step);
            let near = std::mem::take(&mut body.near);
            body.set(surfaces, near.iter().copied());
            body.near = near;
        }
    }

    /// Puts all triangles where they are now, for those who look for them anywhere.
    pub(super) fn set_all(&mut self, surfaces: &mut Surfaces) {
        for body in &self.bodies {
            body.set(surfaces, body.numbers());
            if let Home::Mesh { .. } = body.home {
                surfaces.update(body.numbers());
            }
        }
        surfaces.refit();
    }

    /// Puts all triangles where they are now, for lists that are built.
    pub(super) fn begin_list(&mut self, surfaces: &mut Surfaces, domain: &Domain) {
        self.outside = Vector3::zeros();
        for body in &mut self.bodies {
            self.outside = self.outside.sup(&body.fold(domain));
            body.state.listed = body.placement;
        }
        self.set_all(surfaces);
    }

    /// Takes the triangles that the lists name.
    pub(super) fn end_list(&mut self, surfaces: &Surfaces, named: impl Iterator<Item = u32>) {
        self.marked.fill(false);
        for body in &mut self.bodies {
            body.near.clear();
        }
        for number in named {
            let body = self.of_surface[surfaces.surface_of(number)];
            if let (Some(body), false) = (body, std::mem::replace(&mut self.marked[number as usize], true)) {
                self.bodies[body as usize].near.push(number);
            }
        }
    }

    /// Largest way of a wall since the lists were built [m].
    pub(super) fn travel(&self) -> f64 {
        self.bodies.iter().map(Mover::travel).fold(0.0, f64::max)
    }

    /// Bound on the speed of all walls until a time [m/s].
    pub(super) fn fastest(&self, end_s: f64) -> f64 {
        self.bodies.iter().map(|body| body.course.fastest(&body.corners, end_s)).fold(0.0, f64::max)
    }

    /// Body of a surface, if it moves.
    #[inline(always)]
    pub(super) fn of(&self, surface: usize) -> Option<&Mover> {
        self.of_surface[surface].map(|body| &self.bodies[body as usize])
    }

    /// Books the power [W] of a step [s].
    pub(super) fn book(&mut self, power: f64, step: f64) {
        self.work += 0.5 * step * (self.power + power);
        self.power = power;
    }

    /// Work of the walls on the grains since the start [J].
    pub(super) fn work(&self) -> f64 {
        self.work
    }

    /// Sets the speed of walls that are pressed on with a force, at a time [s], for steps [s]. `borne` gives
    /// the force of the grains on a wall against a direction [N], and the stiffness of their contacts [N/m].
    pub(super) fn steer(&mut self, time: f64, step: f64, borne: impl Fn(u32, &Vector3<f64>) -> [f64; 2]) {
        for body in &mut self.bodies {
            body.state.servo.speed = body.course.servo(time).map_or(0.0, |aim| {
                let [force, stiffness] = borne(body.wall, &aim.direction);
                servo::speed(aim.force, aim.most, force, stiffness, step)
            });
        }
    }

    /// Whether a wall is pressed on with a force at a time [s].
    pub(super) fn has_servo(&self, time: f64) -> bool {
        self.bodies.iter().any(|body| body.course.servo(time).is_some())
    }

    /// Places of the walls that move, by their number in the scene.
    pub(super) fn placements(&self) -> impl Iterator<Item = (u32, Placement)> {
        self.bodies.iter().map(|body| (body.wall, body.placement))
    }

    pub(super) fn state(&self) -> MoversState {
        let bodies = self.bodies.iter().map(|body| body.state).collect();
        MoversState { bodies, work: self.work, power: self.power }
    }

    /// Goes on from a state, with the walls where the lists were built; `Err` says what does not fit.
    pub(super) fn restore(&mut self, state: &MoversState) -> Result<(), String> {
        if state.bodies.len() != self.bodies.len() {
            return Err("it has other walls that move".to_owned());
        }
        for (body, state) in self.bodies.iter_mut().zip(&state.bodies) {
            (body.state, body.placement) = (*state, state.listed);
        }
        (self.work, self.power) = (state.work, state.power);
        Ok(())
    }
}

impl Mover {
    fn new(wall: &Wall, number: u32, numbers: Range<u32>, surfaces: &Surfaces, domain: &Domain) -> Self {
        let (home, ends) = match &wall.shape {
            WallShape::Mesh(mesh) => {
                let facets = numbers.clone().map(|triangle| surfaces.facet(triangle)).collect();
                let bounds = mesh.bounds().unwrap_or([Vector3::zeros(); 2]);
                (Home::Mesh { first: numbers.start, facets }, bounds)
            }
            WallShape::Plane { .. } => {
                let plane = *surfaces.plane(numbers.start).expect("planes are numbered after triangles");
                (Home::Plane { number: numbers.start, plane }, [domain.min(), domain.max()])
            }
        };
        let corner = |k: usize| Vector3::from_fn(|axis, _| ends[k >> axis & 1][axis]);
        let course = Course::new(&wall.motion);
        let rest = Placement::home();
        let state = MoverState { listed: rest, fold: Vector3::zeros(), servo: ServoState::default() };
        let Moment { placement, twist } = course.at(0.0, state.servo);
        Self {
            turns: course.turns(),
            course,
            home,
            corners: std::array::from_fn(corner),
            placement,
            turn: Matrix3::identity(),
            middle: twist,
            end: twist,
            near: Vec::new(),
            state,
            wall: number,
        }
    }

    /// Moves to a time [s], after a step [s].
    fn advance(&mut self, time: f64, step: f64) {
        let MoverState { servo, fold, .. } = &mut self.state;
        let middle = self.course.at(time - 0.5 * step, *servo);
        servo.displacement += servo.speed * step;
        let end = self.course.at(time, *servo);
        let before = self.placement.turn;
        self.placement = Placement { shift: end.placement.shift + *fold, ..end.placement };
        if self.turns {
            self.turn = self.placement.turn * before.transpose();
        }
        let folded = |twist: Twist| Twist { origin: twist.origin - twist.spin.cross(fold), ..twist };
        (self.middle, self.end) = (folded(middle.twist), folded(end.twist));
    }

    /// Numbers of its triangles, or of its plane.
    fn numbers(&self) -> Range<u32> {
        match &self.home {
            Home::Mesh { first, facets } => *first..first + facets.len() as u32,
            Home::Plane { number, .. } => *number..number + 1,
        }
    }

    /// Puts triangles, or the plane, where they are now.
    fn set(&self, surfaces: &mut Surfaces, numbers: impl Iterator<Item = u32>) {
        let Placement { turn, shift } = self.placement;
        match &self.home {
            Home::Mesh { first, facets } if self.turns => {
                for number in numbers {
                    let facet = &facets[(number - first) as usize];
                    let corners = facet.corners.map(|corner| turn * corner + shift);
                    surfaces.set(number, &Facet { corners, normal: turn * facet.normal });
                }
            }
            Home::Mesh { first, facets } => {
                for number in numbers {
                    let facet = &facets[(number - first) as usize];
                    let corners = facet.corners.map(|corner| corner + shift);
                    surfaces.set(number, &Facet { corners, normal: facet.normal });
                }
            }
            Home::Plane { number, plane } => {
                let Plane { point, normal } = *plane;
                let moved = if self.turns {
                    Plane { point: turn * point + shift, normal: turn * normal }
                } else {
                    Plane { point: point + shift, normal }
                };
                surfaces.set_plane(*number, moved);
            }
        }
    }

    /// Way since the lists were built [m]; of a plane, as any place in the domain has it before itself.
    fn travel(&self) -> f64 {
        let (now, then) = (&self.placement, &self.state.listed);
        let moved = |corner: &Vector3<f64>| match &self.home {
            Home::Mesh { .. } => (now.place(corner) - then.place(corner)).norm(),
            Home::Plane { plane, .. } => {
                let height =
                    |at: &Placement| (corner - at.place(&plane.point)).dot(&(at.turn * plane.normal));
                (height(now) - height(then)).abs()
            }
        };
        self.corners.iter().map(moved).fold(0.0, f64::max)
    }

    /// Takes the wall back by whole periods, so that its middle is in the domain; returns how far it stands
    /// out along each periodic axis [m].
    fn fold(&mut self, domain: &Domain) -> Vector3<f64> {
        let mut outside = Vector3::zeros();
        if let Home::Plane { .. } = self.home {
            return outside;
        }
        let middle = (self.corners[0] + self.corners[7]) * 0.5;
        for axis in Axis::ALL.into_iter().filter(|&axis| domain.is_periodic(axis)).map(Axis::index) {
            let (low, length) = (domain.min()[axis], domain.extent()[axis]);
            let periods = ((self.placement.place(&middle)[axis] - low) / length).floor();
            self.placement.shift[axis] -= periods * length;
            self.state.fold[axis] -= periods * length;
            let beyond = self.corners.iter().map(|corner| {
                let place = self.placement.place(corner)[axis];
                (low - place).max(place - low - length)
            });
            outside[axis] = beyond.fold(0.0, f64::max);
        }
        outside
    }

    /// Makes the motion of a contact at a place [m] that of the grain beside the wall, and turns what the
    /// contact remembers with the wall; `step` [s] is that of the springs.
    #[inline(always)]
    pub(super) fn meet(
        &self,
        contact: &mut Contact<f64>,
        history: &mut History<f64>,
        place: &Vector3<f64>,
        arm: f64,
        step: f64,
    ) -> Met {
        let normal = contact.normal;
        let along = |slide: &Vector3<f64>| slide - normal * slide.dot(&normal);
        // The contact was there in the middle of the step.
        let before = place - contact.velocity * (0.5 * step);
        let seen = Met {
            contact: self.end.at(place) + along(&self.end.slide),
            centre: self.end.at(&(place - normal * arm)),
            spin: self.end.spin,
        };
        contact.velocity -= self.middle.at(&before) + along(&self.middle.slide);
        contact.forecast -= seen.contact;
        contact.turning -= self.middle.spin;
        if self.turns {
            history.spring = self.turn * history.spring;
            history.rolling = self.turn * history.rolling;
        }
        seen
    }
}
