//! Potential that two half planes which meet in an edge add to that of a point charge between them:
//!
//! V_induced = q/(4πε) U,  U = G(φ − φ') ∓ G(φ + φ') − 1/R,  − conductors at potential 0, + insulators,
//!
//! in cylindrical coordinates about the edge, the faces at φ = 0 and φ = β. G(ψ) is the potential of a unit
//! charge in a space that closes after an angle 2β. With ν = π/β, ρ² = (r − r')² + z², σ² = (r + r')² + z²,
//!
//! G(ψ) = ∫₀^∞ (2/β) N/(A B) du,  A² = ρ² + u²,  B² = σ² + u²,
//! N = (1 − P²)/(1 − 2P cos νψ + P²),  P = ((A + B)/√(4rr'))^(−2ν).
//!
//! Every pole ψ + 2kβ within (−π, π) is an image that is seen, 1/R_k = ∫₀^∞ (2/π) du/(R_k² + u²). Taken off
//! the integrand one by one, they leave what is smooth on the scale of σ, which Gauss' eight points integrate
//! to 10⁻⁶ of 1/σ. For β = π/n nothing is left but images; β = 2π is Sommerfeld's half plane.
//!
//! Where one face is a conductor and the other an insulator, U is that of conductors at an angle 2β for the
//! charge and its mirror image in the insulator.
//!
//! q charge [C]; ε permittivity [F/m]; r, z, u, R in m; φ, ψ, β in rad. The functions of this file are for
//! q/(4πε) = 1. Range: 0 < β ≤ 2π, both places between the faces or on them, off the edge.
//! Source: Macdonald, Proc. London Math. Soc. 26, 156 (1895); Landau & Lifshitz, Electrodynamics of
//! Continuous Media, 2nd ed., §3; there cosh ζ − cosh η = u²/(2rr').
//!
//! ```
//! use amberfield_laws::wedge::{Face, Wedge};
//! // A charge in a right corner of conductors, 1 from both: three images.
//! let wedge = Wedge::new(std::f64::consts::FRAC_PI_2, [Face::Conductor; 2]);
//! let charge = wedge.around(2.0_f64.sqrt(), std::f64::consts::FRAC_PI_4, 0.0);
//! let images = -0.5 - 0.5 + 1.0 / 8.0_f64.sqrt();
//! assert!((wedge.induced(&charge, &charge).value - images).abs() < 1e-12);
//! ```

use std::f64::consts::{PI, TAU};

/// Number of Gauss' points, and the points with their weights on (0, 1).
const COUNT: usize = 8;
const POINTS: [[f64; 2]; COUNT] = [
    [0.019_855_071_751_231_884, 0.050_614_268_145_188_13],
    [0.101_666_761_293_186_63, 0.111_190_517_226_687_24],
    [0.237_233_795_041_835_5, 0.156_853_322_938_943_64],
    [0.408_282_678_752_175_1, 0.181_341_891_689_181],
    [0.591_717_321_247_825, 0.181_341_891_689_181],
    [0.762_766_204_958_164_5, 0.156_853_322_938_943_64],
    [0.898_333_238_706_813_4, 0.111_190_517_226_687_24],
    [0.980_144_928_248_768_1, 0.050_614_268_145_188_13],
];
/// Least distance from the edge that counts, over that of the two places.
const LEAST: f64 = 1e-9;
/// Angles at which a place sees a charge or an image.
const SEEN: std::ops::Range<f64> = LEAST - PI..PI + LEAST;

/// Condition on a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Face {
    /// Potential 0.
    Conductor,
    /// No normal field.
    Insulator,
}

/// Place around an edge, as one wedge sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// Distance from the edge, r [m].
    pub r: f64,
    /// Angle from the first face, φ [rad].
    pub angle: f64,
    /// Place along the edge, z [m].
    pub along: f64,
    /// exp iφ and exp iνφ.
    turn: Turn,
    ordered: Turn,
}

/// Cosine and sine of an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turn {
    cosine: f64,
    sine: f64,
}

impl Turn {
    fn by(angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        Self { cosine, sine }
    }

    /// Turn by the sum of two angles.
    fn and(self, other: Self) -> Self {
        Self {
            cosine: self.cosine * other.cosine - self.sine * other.sine,
            sine: self.sine * other.cosine + self.cosine * other.sine,
        }
    }

    fn back(self) -> Self {
        Self { sine: -self.sine, ..self }
    }
}

impl Around {
    /// Cosine and sine of φ.
    #[must_use]
    pub fn cosine_and_sine(&self) -> [f64; 2] {
        [self.turn.cosine, self.turn.sine]
    }
}

/// Space between two half planes that meet in an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wedge {
    /// Angle of the space, β [rad].
    angle: f64,
    /// Conditions at φ = 0 and φ = β.
    faces: [Face; 2],
    /// The wedge of conductors that images are found in: at β, or at 2β where the faces are of two kinds.
    whole: Whole,
}

/// Angle β of a wedge with both faces of one kind, ν = π/β, and exp 2iβ.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Whole {
    angle: f64,
    order: f64,
    double: Turn,
}

/// Potential that the faces add to a unit charge's, and its slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Induced {
    /// U [1/m].
    pub value: f64,
    /// Slopes ∂U/∂r, ∂U/∂φ over r, ∂U/∂z [1/m²].
    pub slope: [f64; 3],
}

impl Induced {
    fn add(&mut self, factor: f64, other: &Self) {
        self.value += factor * other.value;
        for (slope, more) in self.slope.iter_mut().zip(other.slope) {
            *slope += factor * more;
        }
    }
}

impl Wedge {
    /// A wedge of an angle [rad] between faces.
    #[must_use]
    pub fn new(angle: f64, faces: [Face; 2]) -> Self {
        let whole = if faces[0] == faces[1] { angle } else { 2.0 * angle };
        let whole = Whole { angle: whole, order: PI / whole, double: Turn::by(2.0 * whole) };
        Self { angle, faces, whole }
    }

    /// Angle of the space, β [rad].
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Conditions on the faces at φ = 0 and φ = β.
    #[must_use]
    pub fn faces(&self) -> [Face; 2] {
        self.faces
    }

    /// Place at a distance r from the edge [m], an angle φ from the first face [rad], and z along it [m].
    #[must_use]
    pub fn around(&self, r: f64, angle: f64, along: f64) -> Around {
        let is_turned = self.faces == [Face::Insulator, Face::Conductor];
        let seen = if is_turned { self.angle - angle } else { angle };
        Around { r, angle, along, turn: Turn::by(angle), ordered: Turn::by(self.whole.order * seen) }
    }

    /// Potential U that the faces add to that of a unit charge, with its slopes, at a place.
    #[must_use]
    pub fn induced(&self, place: &Around, charge: &Around) -> Induced {
        match self.faces {
            [Face::Conductor, Face::Conductor] => self.whole.induced(-1.0, place, charge),
            [Face::Insulator, Face::Insulator] => self.whole.induced(1.0, place, charge),
            [Face::Conductor, Face::Insulator] => self.with_mirrored(place, charge),
            [Face::Insulator, Face::Conductor] => {
                let turned = |other: &Around| Around {
                    angle: self.angle - other.angle,
                    turn: Turn::by(self.angle - other.angle),
                    ..*other
                };
                let mut induced = self.with_mirrored(&turned(place), &turned(charge));
                induced.slope[1] = -induced.slope[1];
                induced
            }
        }
    }

    /// U between conductors at twice the angle, of a charge and of its mirror image in the insulator at β.
    fn with_mirrored(&self, place: &Around, charge: &Around) -> Induced {
        let angle = 2.0 * self.angle - charge.angle;
        let ordered = Turn::by(self.whole.order * angle);
        let image = Around { angle, turn: Turn::by(angle), ordered, ..*charge };
        let mut induced = self.whole.induced(-1.0, place, charge);
        induced.add(1.0, &self.whole.induced(-1.0, place, &image));
        induced.add(1.0, &Pair::new(place, &image).seen_at(place.turn.and(image.turn.back())).point());
        induced
    }
}

impl Whole {
    /// U of one charge between faces of one kind; `sign` is that of the images in them.
    fn induced(&self, sign: f64, place: &Around, charge: &Around) -> Induced {
        let pair = Pair::new(place, charge);
        let mut induced = Induced::default();
        let own = place.angle - charge.angle;
        let turn = place.turn.and(charge.turn.back());
        let is_seen = SEEN.contains(&own);
        if !is_seen {
            induced.add(-1.0, &pair.seen_at(turn).point());
        }
        let of_charge = Part::new(self, own, turn, place.ordered.and(charge.ordered.back()), &pair);
        let mirrored = place.turn.and(charge.turn);
        let of_images =
            Part::new(self, place.angle + charge.angle, mirrored, place.ordered.and(charge.ordered), &pair);
        for image in of_charge.images[..of_charge.count].iter().skip(usize::from(is_seen)) {
            induced.add(1.0, &image.point());
        }
        for image in &of_images.images[..of_images.count] {
            induced.add(sign, &image.point());
        }
        let nodes = Nodes::new(&pair, self.angle);
        induced.add(1.0, &nodes.rest(&pair, &of_charge));
        induced.add(sign, &nodes.rest(&pair, &of_images));
        induced
    }
}

/// Two places about an edge.
struct Pair {
    /// r, r', z [m].
    r: f64,
    other: f64,
    along: f64,
    /// ρ², σ² [m²].
    near: f64,
    far: f64,
}

impl Pair {
    fn new(place: &Around, charge: &Around) -> Self {
        let along = place.along - charge.along;
        let least = LEAST * (place.r + charge.r + along.abs());
        let (r, other) = (place.r.max(least), charge.r.max(least));
        let square = along * along;
        Self { r, other, along, near: (r - other).powi(2) + square, far: (r + other).powi(2) + square }
    }

    /// Looks at the other place at an angle from this one.
    fn seen_at(&self, turn: Turn) -> Seen {
        Seen {
            distance_squared: self.near + 2.0 * self.r * self.other * (1.0 - turn.cosine),
            half_slopes: [self.r - self.other * turn.cosine, self.other * turn.sine, self.along],
        }
    }
}

/// Charge or image as a place sees it: R² [m²], and half its slopes along r, across it and along z [m].
#[derive(Clone, Copy, Default)]
struct Seen {
    distance_squared: f64,
    half_slopes: [f64; 3],
}

impl Seen {
    fn point(&self) -> Induced {
        let value = self.distance_squared.sqrt().recip();
        let cube = -value * value * value;
        Induced { value, slope: self.half_slopes.map(|slope| cube * slope) }
    }
}

/// Images at most that are told apart; in a wedge below π/12 the farthest are left to the integral.
const MOST: usize = 12;

/// G(ψ) but for its images that are seen, |ψ + 2kβ| ≤ π; half a turn either way is one place.
struct Part {
    /// exp iνψ and ν.
    ordered: Turn,
    order: f64,
    /// Images, the nearest turns first.
    images: [Seen; MOST],
    count: usize,
}

impl Part {
    #[inline]
    fn new(whole: &Whole, psi: f64, turn: Turn, ordered: Turn, pair: &Pair) -> Self {
        let mut part = Self { ordered, order: whole.order, images: [Seen::default(); MOST], count: 0 };
        part.take(psi, turn, pair);
        let by = 2.0 * whole.angle;
        let (mut less, mut more) = ((psi, turn), (psi, turn));
        // ψ is within 2β of 0.
        while part.count < MOST && (less.0 > -PI || more.0 < PI) {
            less = (less.0 - by, less.1.and(whole.double.back()));
            more = (more.0 + by, more.1.and(whole.double));
            part.take(less.0, less.1, pair);
            part.take(more.0, more.1, pair);
        }
        part
    }

    fn take(&mut self, angle: f64, turn: Turn, pair: &Pair) {
        if SEEN.contains(&angle) && self.count < MOST {
            self.images[self.count] = pair.seen_at(turn);
            self.count += 1;
        }
    }
}

/// Integrand's factors at one u.
#[derive(Clone, Copy)]
struct Node {
    weight: f64,
    square: f64,
    /// 2/(β A B), and its slopes along r and z over itself.
    factor: f64,
    of_factor: [f64; 2],
    /// P, and its slopes along r and z.
    power: f64,
    of_power: [f64; 2],
}

/// Factors of the integrand at all points of u.
struct Nodes([Node; COUNT]);

impl Nodes {
    fn new(pair: &Pair, beta: f64) -> Self {
        let scale = pair.far.sqrt();
        let double_order = TAU / beta;
        let half_over = 0.5 / (pair.r * pair.other).sqrt();
        let (own, less, more) = (0.5 / pair.r, pair.r - pair.other, pair.r + pair.other);
        Self(POINTS.map(|[point, weight]| {
            let back = 1.0 / (1.0 - point);
            let u = scale * point * back;
            let (a, b) = ((pair.near + u * u).sqrt(), (pair.far + u * u).sqrt());
            let (over_a, over_b, over_both) = (1.0 / a, 1.0 / b, 1.0 / (a + b));
            let of_a = [less * over_a, pair.along * over_a];
            let of_b = [more * over_b, pair.along * over_b];
            let power = raised((a + b) * half_over, -double_order);
            let growth = [(of_a[0] + of_b[0]) * over_both - own, (of_a[1] + of_b[1]) * over_both];
            Node {
                weight: weight * scale * back * back,
                square: u * u,
                factor: 2.0 / beta * over_a * over_b,
                of_factor: [-of_a[0] * over_a - of_b[0] * over_b, -of_a[1] * over_a - of_b[1] * over_b],
                power,
                of_power: growth.map(|slope| -double_order * power * slope),
            }
        }))
    }

    /// Rest of G(ψ) besides the images that are seen.
    fn rest(&self, pair: &Pair, part: &Part) -> Induced {
        let c = part.ordered.cosine;
        let (mut value, mut along, mut across, mut beside) = (0.0, 0.0, 0.0, 0.0);
        for node in &self.0 {
            let p = node.power;
            let below = 1.0 / (1.0 - 2.0 * p * c + p * p);
            let quotient = (1.0 - p * p) * below;
            let of_p = (2.0 * c - 4.0 * p + 2.0 * c * p * p) * below * below;
            let of_c = (1.0 - p * p) * 2.0 * p * below * below;
            let whole = node.weight * node.factor;
            value += whole * quotient;
            along += whole * (quotient * node.of_factor[0] + of_p * node.of_power[0]);
            across -= whole * of_c;
            beside += whole * (quotient * node.of_factor[1] + of_p * node.of_power[1]);
        }
        let mut slope = [along, across * part.order * part.ordered.sine / pair.r, beside];
        for Seen { distance_squared, half_slopes } in &part.images[..part.count] {
            let (mut poles, mut squares) = (0.0, 0.0);
            for node in &self.0 {
                let pole = 1.0 / (distance_squared + node.square);
                poles += node.weight * pole;
                squares += node.weight * pole * pole;
            }
            value -= 2.0 / PI * poles;
            for (slope, half) in slope.iter_mut().zip(half_slopes) {
                *slope += 4.0 / PI * squares * half;
            }
        }
        Induced { value, slope }
    }
}

/// Number raised to a negative power; whole powers are products.
fn raised(number: f64, power: f64) -> f64 {
    /// Largest whole power by products.
    const LARGEST: i32 = 12;
    match (1..=LARGEST).find(|whole| (power + f64::from(*whole)).abs() < f64::EPSILON) {
        Some(whole) => number.powi(whole).recip(),
        None => (power * number.ln()).exp(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONDUCTORS: [Face; 2] = [Face::Conductor; 2];
    const INSULATORS: [Face; 2] = [Face::Insulator; 2];
    const ANGLES: [f64; 9] = [0.3, 0.9, 1.5, 2.3, 3.0, 3.6, 4.712_388_980_384_69, 5.8, TAU];

    fn distance(a: &Around, b: &Around) -> f64 {
        let across = a.r * a.r + b.r * b.r - 2.0 * a.r * b.r * (a.angle - b.angle).cos();
        (across + (a.along - b.along).powi(2)).sqrt()
    }

    #[test]
    fn conductors_have_no_potential_and_insulators_no_slope() {
        for beta in ANGLES {
            let [conductors, insulators] = [CONDUCTORS, INSULATORS].map(|faces| Wedge::new(beta, faces));
            let charge = conductors.around(1.0, 0.37 * beta, 0.0);
            for (r, along) in [(0.2, 0.1), (1.0, 0.0), (1.3, -0.8), (4.0, 1.0)] {
                for angle in [0.0, beta] {
                    let place = conductors.around(r, angle, along);
                    let own = 1.0 / distance(&place, &charge);
                    let total = own + conductors.induced(&place, &charge).value;
                    assert!(total.abs() < 5e-6, "{beta} {r} {angle}: {total}");
                    let own = -charge.r * (angle - charge.angle).sin() * own.powi(3);
                    let total = own + insulators.induced(&place, &charge).slope[1];
                    assert!(total.abs() < 3e-5, "{beta} {r} {angle}: {total}");
                }
            }
        }
    }

    #[test]
    fn mixed_faces_have_each_its_own_condition_from_either_side() {
        for beta in [0.7, 1.9, 3.0] {
            for faces in [[Face::Conductor, Face::Insulator], [Face::Insulator, Face::Conductor]] {
                let wedge = Wedge::new(beta, faces);
                let charge = wedge.around(1.0, 0.3 * beta, 0.0);
                for (face, angle) in faces.into_iter().zip([0.0, beta]) {
                    let place = wedge.around(0.8, angle, 0.3);
                    let own = 1.0 / distance(&place, &charge);
                    let of_faces = wedge.induced(&place, &charge);
                    let total = match face {
                        Face::Conductor => own + of_faces.value,
                        Face::Insulator => {
                            of_faces.slope[1] - charge.r * (angle - charge.angle).sin() * own.powi(3)
                        }
                    };
                    assert!(total.abs() < 3e-5, "{beta} {faces:?} {angle}: {total}");
                }
            }
        }
    }

    #[test]
    fn potential_is_symmetric_and_its_slopes_are_its_own_and_it_is_harmonic() {
        for beta in ANGLES {
            let wedge = Wedge::new(beta, CONDUCTORS);
            let charge = wedge.around(1.0, 0.4 * beta, 0.0);
            for place in [wedge.around(0.7, 0.7 * beta, 0.4), wedge.around(1.02, 0.41 * beta, 0.01)] {
                let at = |r: f64, angle: f64, along: f64| {
                    let moved = wedge.around(place.r + r, place.angle + angle, place.along + along);
                    wedge.induced(&moved, &charge).value
                };
                let here = wedge.induced(&place, &charge);
                assert!((here.value - wedge.induced(&charge, &place).value).abs() < 2e-6, "{beta}");
                let h = 1e-4;
                let slopes = [
                    (at(h, 0.0, 0.0) - at(-h, 0.0, 0.0)) / (2.0 * h),
                    (at(0.0, h, 0.0) - at(0.0, -h, 0.0)) / (2.0 * h * place.r),
                    (at(0.0, 0.0, h) - at(0.0, 0.0, -h)) / (2.0 * h),
                ];
                for (given, found) in here.slope.iter().zip(slopes) {
                    assert!((given - found).abs() < 1e-5 * (1.0 + found.abs()), "{beta} {given} {found}");
                }
                let h = 1e-3;
                let second = |plus: f64, minus: f64| (plus + minus - 2.0 * here.value) / (h * h);
                let laplacian = second(at(h, 0.0, 0.0), at(-h, 0.0, 0.0))
                    + here.slope[0] / place.r
                    + second(at(0.0, h, 0.0), at(0.0, -h, 0.0)) / (place.r * place.r)
                    + second(at(0.0, 0.0, h), at(0.0, 0.0, -h));
                let scale = at(0.0, 0.0, 0.0).abs().powi(3);
                assert!(laplacian.abs() < 2e-3 * scale.max(1.0), "{beta} {laplacian}");
            }
        }
    }

    #[test]
    fn images_are_all_there_is_where_the_angle_divides_pi() {
        let beta = PI / 3.0;
        let wedge = Wedge::new(beta, CONDUCTORS);
        let (charge, place) = (wedge.around(2.0, 0.4, 0.0), wedge.around(1.5, 0.8, 0.5));
        let images = [(-1.0, -0.4), (1.0, 2.0 * beta + 0.4), (-1.0, 2.0 * beta - 0.4)];
        let more = [(1.0, -2.0 * beta + 0.4), (-1.0, -2.0 * beta - 0.4)];
        let exact: f64 = images
            .iter()
            .chain(&more)
            .map(|(sign, angle)| sign / distance(&place, &wedge.around(2.0, *angle, 0.0)))
            .sum();
        let found = wedge.induced(&place, &charge).value;
        assert!((found - exact).abs() < 1e-12, "{found} {exact}");
    }
}
