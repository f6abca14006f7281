//! Images of a point in the faces of a box: the one place that knows how a conductor, an insulator, a
//! periodic and an open face mirror a charge.
//!
//! Along one axis the images of a coordinate x are ±x + offset + m·period with a sign for the charge: a
//! conductor reverses it, an insulator keeps it. The images of a point are all products over the three axes.

use amberfield_core::{Axis, Boundary, Domain, Side};
use nalgebra::Vector3;

/// Effect of a face that is not periodic on a charge's mirror image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaceKind {
    /// Potential prescribed: the image has the opposite charge.
    Conductor,
    /// Normal field prescribed: the image has the same charge.
    Insulator,
    /// Free space: no image.
    Open,
}

/// The two faces of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AxisKind {
    /// Both faces joined.
    Periodic,
    /// Lower and upper face.
    Faces(FaceKind, FaceKind),
}

impl AxisKind {
    /// The kind of an axis of the domain.
    pub(crate) fn of(domain: &Domain, axis: Axis) -> Self {
        if domain.is_periodic(axis) {
            return Self::Periodic;
        }
        let kind = |side| match domain.face(axis, side) {
            face if face.is_conductor() => FaceKind::Conductor,
            Boundary::Open => FaceKind::Open,
            _ => FaceKind::Insulator,
        };
        Self::Faces(kind(Side::Min), kind(Side::Max))
    }

    /// Whether at least one face is open.
    pub(crate) fn is_open(self) -> bool {
        matches!(self, Self::Faces(lower, upper) if lower == FaceKind::Open || upper == FaceKind::Open)
    }

    /// Whether at least one face is a conductor.
    pub(crate) fn has_conductor(self) -> bool {
        matches!(
            self,
            Self::Faces(lower, upper) if [lower, upper].contains(&FaceKind::Conductor)
        )
    }
}

/// Kinds of the three axes.
pub(crate) fn axis_kinds(domain: &Domain) -> [AxisKind; 3] {
    Axis::ALL.map(|axis| AxisKind::of(domain, axis))
}

/// Open faces of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Geometry {
    /// No open face: infinitely many images along every axis.
    Closed,
    /// Every axis has an open face: at most eight images.
    Open,
    /// Two closed axes and the given axis with an open face.
    Slab(Axis),
    /// The given axis closed, between two axes with an open face: two plates with open sides.
    Gap(Axis),
}

impl Geometry {
    /// The class of a domain.
    pub(crate) fn of(domain: &Domain) -> Self {
        let kinds = axis_kinds(domain);
        let (open, closed): (Vec<Axis>, Vec<Axis>) =
            Axis::ALL.into_iter().partition(|axis| kinds[axis.index()].is_open());
        match (open.as_slice(), closed.as_slice()) {
            ([], _) => Self::Closed,
            ([axis], _) => Self::Slab(*axis),
            (_, [axis]) => Self::Gap(*axis),
            _ => Self::Open,
        }
    }
}

/// One image along one axis: x ↦ scale·x + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisImage {
    /// +1 (moved) or −1 (mirrored).
    pub(crate) scale: f64,
    /// Offset [m].
    pub(crate) offset: f64,
    /// Factor on the charge, ±1.
    pub(crate) sign: f64,
}

impl AxisImage {
    const IDENTITY: Self = Self { scale: 1.0, offset: 0.0, sign: 1.0 };

    fn mirrored_at(face: f64, sign: f64) -> Self {
        Self { scale: -1.0, offset: 2.0 * face, sign }
    }

    /// The image of a coordinate [m], without periods.
    pub(crate) fn apply(self, x: f64) -> f64 {
        if self.scale > 0.0 { x + self.offset } else { self.offset - x }
    }
}

/// All images along one axis; the first is the point itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AxisImages {
    /// Distance [m] after which the images repeat; `None` where they are finitely many.
    pub(crate) period: Option<f64>,
    /// Images within one period.
    pub(crate) images: Vec<AxisImage>,
}

impl AxisImages {
    /// Images of an axis from `low` to `high` [m].
    pub(crate) fn new(kind: AxisKind, low: f64, high: f64) -> Self {
        use FaceKind::{Conductor, Insulator, Open};
        let length = high - low;
        let identity = AxisImage::IDENTITY;
        let sign = |face| if face == Conductor { -1.0 } else { 1.0 };
        match kind {
            AxisKind::Periodic => Self { period: Some(length), images: vec![identity] },
            AxisKind::Faces(Open, Open) => Self { period: None, images: vec![identity] },
            AxisKind::Faces(Open, face) => {
                Self { period: None, images: vec![identity, AxisImage::mirrored_at(high, sign(face))] }
            }
            AxisKind::Faces(face, Open) => {
                Self { period: None, images: vec![identity, AxisImage::mirrored_at(low, sign(face))] }
            }
            AxisKind::Faces(Conductor, Conductor) | AxisKind::Faces(Insulator, Insulator) => Self {
                period: Some(2.0 * length),
                images: vec![
                    identity,
                    AxisImage::mirrored_at(low, if kind.has_conductor() { -1.0 } else { 1.0 }),
                ],
            },
            AxisKind::Faces(lower, upper) => Self {
                period: Some(4.0 * length),
                images: vec![
                    identity,
                    AxisImage::mirrored_at(low, sign(lower)),
                    AxisImage::mirrored_at(high, sign(upper)),
                    AxisImage { scale: 1.0, offset: 2.0 * length, sign: -1.0 },
                ],
            },
        }
    }

    /// Only the periodic copies along the axis; faces that are not periodic mirror nothing.
    pub(crate) fn periodic_only(kind: AxisKind, low: f64, high: f64) -> Self {
        let period = (kind == AxisKind::Periodic).then_some(high - low);
        Self { period, images: vec![AxisImage::IDENTITY] }
    }

    /// Whether an image of any coordinate from `from` to `to` lies in the closed interval from `low` to
    /// `high` [m].
    fn reach(&self, [from, to]: [f64; 2], low: f64, high: f64) -> bool {
        self.images.iter().any(|image| {
            let ends = [image.apply(from), image.apply(to)];
            let (first, last) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            // The last image that begins at or below the interval's end, up to rounding: that one too many is
            // looked at does not matter.
            let periods = self.period.map_or(0.0, |period| ((high - first) / period).floor() * period);
            let begins_below = self.period.is_some() || first <= high;
            begins_below && last + periods >= low
        })
    }

    /// Calls `visit` for every image of `x` in the closed interval from `low` to `high` [m].
    fn for_each_between(&self, x: f64, low: f64, high: f64, mut visit: impl FnMut(AxisCopy)) {
        for (index, image) in self.images.iter().enumerate() {
            let base = image.apply(x);
            let (first, last) = match self.period {
                None => (0, 0),
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "number of periods within a cut-off radius"
                )]
                Some(period) => {
                    (((low - base) / period).ceil() as i32, ((high - base) / period).floor() as i32)
                }
            };
            for periods in first..=last {
                let coordinate = base + f64::from(periods) * self.period.unwrap_or(0.0);
                if self.period.is_some() || (low..=high).contains(&coordinate) {
                    let real = index == 0 && periods == 0;
                    visit(AxisCopy { coordinate, sign: image.sign, periods, real });
                }
            }
        }
    }
}

/// One image of a coordinate.
#[derive(Clone, Copy)]
struct AxisCopy {
    coordinate: f64,
    sign: f64,
    periods: i32,
    real: bool,
}

/// One image of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Image {
    /// Position [m].
    pub(crate) position: Vector3<f64>,
    /// Factor on the charge, ±1.
    pub(crate) sign: f64,
    /// Whole periods by which it is moved along each axis.
    pub(crate) periods: [i32; 3],
    /// Whether it is the point itself.
    pub(crate) is_real: bool,
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundingBox {
    /// Lower corner [m].
    pub(crate) min: Vector3<f64>,
    /// Upper corner [m].
    pub(crate) max: Vector3<f64>,
}

impl BoundingBox {
    /// The smallest box that holds the points; `None` when there is no point.
    pub(crate) fn around(points: &[Vector3<f64>]) -> Option<Self> {
        let first = *points.first()?;
        let start = Self { min: first, max: first };
        Some(points.iter().fold(start, |all, p| Self { min: all.min.inf(p), max: all.max.sup(p) }))
    }

    /// Edge lengths [m].
    pub(crate) fn extent(&self) -> Vector3<f64> {
        self.max - self.min
    }

    /// Whether a point lies strictly inside.
    pub(crate) fn contains(&self, point: &Vector3<f64>) -> bool {
        (0..3).all(|axis| self.min[axis] < point[axis] && point[axis] < self.max[axis])
    }

    /// Square of the distance of a point to the box, zero inside [m²].
    pub(crate) fn distance_squared(&self, point: &Vector3<f64>) -> f64 {
        (point - point.sup(&self.min).inf(&self.max)).norm_squared()
    }
}

/// The images of any point in a box.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ImageLattice {
    /// Images along each axis.
    pub(crate) axes: [AxisImages; 3],
}

impl ImageLattice {
    /// The images in all faces of the domain.
    pub(crate) fn new(domain: &Domain) -> Self {
        Self::build(domain, AxisImages::new)
    }

    /// Periodic copies alone, no mirror images.
    pub(crate) fn periodic_only(domain: &Domain) -> Self {
        Self::build(domain, AxisImages::periodic_only)
    }

    fn build(domain: &Domain, images: impl Fn(AxisKind, f64, f64) -> AxisImages) -> Self {
        let (min, max) = (domain.min(), domain.max());
        let axes =
            Axis::ALL.map(|axis| images(AxisKind::of(domain, axis), min[axis.index()], max[axis.index()]));
        Self { axes }
    }

    /// Calls `visit` for every image of `x` that lies within `radius` of the target box, the point itself
    /// included.
    pub(crate) fn for_each_near(
        &self,
        x: &Vector3<f64>,
        target: &BoundingBox,
        radius: f64,
        mut visit: impl FnMut(Image),
    ) {
        let (low, high) = (target.min.add_scalar(-radius), target.max.add_scalar(radius));
        let outside = |axis: usize, at: f64| (target.min[axis] - at).max(at - target.max[axis]).max(0.0);
        self.axes[0].for_each_between(x[0], low[0], high[0], |first| {
            let distance_x = outside(0, first.coordinate).powi(2);
            self.axes[1].for_each_between(x[1], low[1], high[1], |second| {
                let distance_xy = distance_x + outside(1, second.coordinate).powi(2);
                self.axes[2].for_each_between(x[2], low[2], high[2], |third| {
                    if distance_xy + outside(2, third.coordinate).powi(2) <= radius * radius {
                        visit(Image {
                            position: Vector3::new(first.coordinate, second.coordinate, third.coordinate),
                            sign: first.sign * second.sign * third.sign,
                            periods: [first.periods, second.periods, third.periods],
                            is_real: first.real && second.real && third.real,
                        });
                    }
                });
            });
        });
    }

    /// Whether an image of any point of a box may lie within `radius` [m] of another.
    pub(crate) fn reaches(&self, from: &BoundingBox, target: &BoundingBox, radius: f64) -> bool {
        (0..3).all(|axis| {
            let (low, high) = (target.min[axis] - radius, target.max[axis] + radius);
            self.axes[axis].reach([from.min[axis], from.max[axis]], low, high)
        })
    }

    /// Calls `visit` for every image without periods: all there are in an open box.
    pub(crate) fn for_each_finite(&self, x: &Vector3<f64>, mut visit: impl FnMut(Image)) {
        for (i, first) in self.axes[0].images.iter().enumerate() {
            for (j, second) in self.axes[1].images.iter().enumerate() {
                for (k, third) in self.axes[2].images.iter().enumerate() {
                    visit(Image {
                        position: Vector3::new(first.apply(x[0]), second.apply(x[1]), third.apply(x[2])),
                        sign: first.sign * second.sign * third.sign,
                        periods: [0; 3],
                        is_real: i + j + k == 0,
                    });
                }
            }
        }
    }
}

/// The part of a domain none of whose points has an image, but itself, within `radius` [m] of a target box;
/// empty where the target lies outside the domain.
pub(crate) fn without_images(domain: &Domain, target: &BoundingBox, radius: f64) -> BoundingBox {
    let is_inside =
        |axis: usize| domain.min()[axis] <= target.min[axis] && target.max[axis] <= domain.max()[axis];
    if (0..3).all(is_inside) {
        BoundingBox { min: domain.min().add_scalar(radius), max: domain.max().add_scalar(-radius) }
    } else {
        BoundingBox { min: domain.max(), max: domain.min() }
    }
}

/// Images per charge in a box without closed axes.
pub(crate) fn images_per_charge(domain: &Domain) -> usize {
    ImageLattice::new(domain).axes.iter().map(|axis| axis.images.len()).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use FaceKind::{Conductor, Insulator, Open};

    /// Sum of the smooth 1-D test function over all signed images, seen from `at`.
    fn smooth_sum(kind: AxisKind, x: f64, at: f64) -> f64 {
        let mut sum = 0.0;
        AxisImages::new(kind, 0.5, 2.0).for_each_between(x, -40.0, 40.0, |copy| {
            sum += copy.sign * (-(copy.coordinate - at).powi(2)).exp()
        });
        sum
    }

    #[test]
    fn conductors_have_no_potential_and_insulators_no_slope() {
        for lower in [Conductor, Insulator, Open] {
            for upper in [Conductor, Insulator, Open] {
                let kind = AxisKind::Faces(lower, upper);
                for (face, at) in [(lower, 0.5), (upper, 2.0)] {
                    let slope = smooth_sum(kind, 0.8, at + 1e-5) - smooth_sum(kind, 0.8, at - 1e-5);
                    match face {
                        Conductor => assert!(smooth_sum(kind, 0.8, at).abs() < 1e-14, "{kind:?}"),
                        Insulator => assert!(slope.abs() < 1e-14, "{kind:?}"),
                        Open => {}
                    }
                }
            }
        }
    }

    /// Here the interval's end less the first coordinate, over the period, rounds up to a whole number.
    #[test]
    fn a_box_reaches_itself_however_the_ends_round() {
        let images = AxisImages::new(AxisKind::Periodic, 0.0, 0.7);
        let (low, high) = (0.099_999_999_999_999_97, 0.499_999_999_999_999_94);
        let radius = high;
        assert!(images.reach([0.3, 0.399_999_999_999_999_97], low - radius, high + radius));
        assert!(!images.reach([0.3, 0.35], 0.36, 0.99));
        let mirrored = AxisImages::new(AxisKind::Faces(Conductor, Open), 0.0, 1.0);
        assert!(mirrored.reach([0.1, 0.2], -0.15, -0.12) && !mirrored.reach([0.1, 0.2], 0.3, 2.0));
    }

    #[test]
    fn images_near_a_box_are_all_within_the_radius() {
        let kind = [Boundary::Grounded, Boundary::Insulating { normal_field_v_m: 0.0 }];
        let faces = [kind, [Boundary::Periodic; 2], [Boundary::Grounded; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::new(1.0, 1.5, 0.7), faces).unwrap();
        let lattice = ImageLattice::new(&domain);
        let target = BoundingBox { min: domain.min(), max: domain.max() };
        let (mut count, mut real) = (0, 0);
        lattice.for_each_near(&Vector3::new(0.2, 0.3, 0.6), &target, 4.0, |image| {
            let nearest = image.position.sup(&target.min).inf(&target.max);
            assert!((image.position - nearest).norm() <= 4.0);
            count += 1;
            real += usize::from(image.is_real);
        });
        assert_eq!(real, 1);
        // Box swept by a ball of radius 4, over the volume of one image (that of the domain).
        let expected = (1.05
            + 2.0 * 4.0 * (1.5 + 0.7 + 1.05)
            + std::f64::consts::PI * 16.0 * 3.2
            + 4.0 / 3.0 * std::f64::consts::PI * 64.0)
            / 1.05;
        assert!((f64::from(count) / expected - 1.0).abs() < 0.1, "{count} of about {expected}");
    }
}
