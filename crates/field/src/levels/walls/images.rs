//! Images and ghosts of one charge in all walls near it.
//!
//! Mirrors behind which images can lie reflect the charge and each other's images: two at an angle make a
//! third image, two that face each other a row of images. Screens then reflect the charge and all of those,
//! one screen after the other: what the first hides or shows, the next hides and mirrors again.

use super::boundary::Carrier;
use super::ghosts::{Confined, Ghost, Shown};
use super::mirror::{AtEdge, Mirror, Screened};
use super::screen::Screen;
use nalgebra::Vector3;

/// Image charges below this share of their charge are left out.
const LEAST: f64 = 1e-9;
/// Cosine of the angle of walls that face each other.
const FACING: f64 = -0.9;
/// Walls that mirror one charge at most.
const MOST: usize = 6;
/// Images in one of two facing walls at most.
const LONGEST_ROW: usize = 12;

/// A mirror, and what its images' charges are multiplied with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection {
    pub(super) mirror: Mirror,
    pub(super) sign: f64,
    /// Whether the wall ends at the edge beside the charge.
    pub(super) is_at_edge: bool,
}

/// Image of a charge that every place feels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image {
    /// Place [m].
    pub(crate) at: Vector3<f64>,
    /// Charge of the image over the charge's.
    pub(crate) factor: f64,
}

/// Images and ghosts of a unit charge.
#[derive(Clone, Debug, Default)]
pub(crate) struct Images {
    /// Images that every place feels.
    pub(crate) plain: Vec<Image>,
    /// Ghosts, which only hidden places feel.
    pub(crate) ghosts: Vec<Ghost>,
    carrier: Carrier,
    solid: Vec<Reflection>,
    screens: Vec<Reflection>,
    sources: Vec<Source>,
}

/// A charge, image or ghost that screens are to reflect.
#[derive(Clone, Copy, Debug)]
struct Source {
    at: Vector3<f64>,
    factor: f64,
    /// Whether it is the charge itself.
    is_charge: bool,
    /// Bounds that confine it; first the screen that made it.
    bounds: [Option<Bound>; 2],
    /// Whether it is what its screen hides, not what it mirrors.
    hides: bool,
}

/// Side of a screen to which a ghost is confined.
#[derive(Clone, Copy, Debug)]
struct Bound {
    /// Number of the screen.
    screen: usize,
    /// +1: before it; −1: behind it.
    above: f64,
}

impl Images {
    /// No images yet; those to come leave a field that something carries.
    pub(super) fn new(carrier: Carrier) -> Self {
        Self { carrier, ..Self::default() }
    }

    /// Makes the images and ghosts of a unit charge at a point, beside an edge or not.
    pub(super) fn take(
        &mut self,
        point: &Vector3<f64>,
        edge: Option<&AtEdge>,
        reflections: impl Iterator<Item = Reflection> + Clone,
    ) {
        self.plain.clear();
        self.ghosts.clear();
        if let Some(edge) = edge {
            // What the other walls make of the charge, the edge's faces reflect.
            self.reflect_in(point, reflections.clone().filter(|reflection| !reflection.is_at_edge));
            self.plain.clear();
            self.ghosts.clear();
            self.add_edge(edge);
        }
        self.reflect_in(point, reflections);
    }

    /// Adds the images and ghosts that some walls make of a unit charge at a point.
    fn reflect_in(&mut self, point: &Vector3<f64>, reflections: impl Iterator<Item = Reflection>) {
        self.solid.clear();
        self.screens.clear();
        let is_felt = |reflection: &Reflection| (reflection.sign * reflection.mirror.factor()).abs() >= LEAST;
        for reflection in reflections.filter(is_felt).take(MOST) {
            // A foot on the line between two walls in one plane is on both.
            let mut known = self.solid.iter().chain(&self.screens);
            if known.any(|other| other.mirror.is_same_plane(&reflection.mirror)) {
                continue;
            }
            let screened = reflection.mirror.screened.is_some();
            if screened { self.screens.push(reflection) } else { self.solid.push(reflection) }
        }
        self.leave_out_hidden();
        self.screen_those_that_face_screens();
        self.add_solid(0, Image { at: *point, factor: 1.0 }, &mut Vec::new());
        self.add_screens(point);
    }

    /// Adds the ghosts that an edge makes of the charge and of what other walls have made of it.
    fn add_edge(&mut self, edge: &AtEdge) {
        for source in &self.sources {
            let confined = source.bounds.map(|bound| self.confined(bound));
            for (screen, share) in edge.screens.iter().flatten().filter(|(_, share)| *share != 0.0) {
                let (charge, shown) = (share * source.factor, Shown::Around(*screen));
                self.ghosts.push(Ghost { at: source.at, charge, extent: edge.extent, shown, confined });
            }
        }
    }

    fn confined(&self, bound: Option<Bound>) -> Option<Confined> {
        let Bound { screen, above } = bound?;
        Some(Confined { screen: self.screens[screen].mirror.screened?.screen, above })
    }

    /// Leaves out walls behind others, which the charge does not see.
    fn leave_out_hidden(&mut self) {
        let all: Vec<Mirror> = self.solid.iter().chain(&self.screens).map(|wall| wall.mirror).collect();
        let is_seen = |wall: &Reflection| !all.iter().any(|front| front.hides(&wall.mirror));
        self.solid.retain(is_seen);
        self.screens.retain(is_seen);
    }

    /// Makes screens of solid walls that face a screen: what it mirrors again is no plain image.
    fn screen_those_that_face_screens(&mut self) {
        let mut number = 0;
        while let Some(reflection) = self.solid.get(number).copied() {
            let mut screens = self.screens.iter();
            let Some(facing) = screens.find(|screen| faces(&screen.mirror, &reflection.mirror)) else {
                number += 1;
                continue;
            };
            let Mirror { normal, offset, .. } = reflection.mirror;
            let Some(of_facing) = facing.mirror.screened else { break };
            let screened = Screened { screen: Screen::Plane { normal, offset }, ..of_facing };
            let mirror = Mirror { screened: Some(screened), ..reflection.mirror };
            self.screens.push(Reflection { mirror, ..reflection });
            self.solid.remove(number);
            number = 0;
        }
    }

    /// Adds the images of `before` in every mirror from `from` on, and those of these images in later ones
    /// that stand across all that were used.
    fn add_solid(&mut self, from: usize, before: Image, used: &mut Vec<usize>) {
        for number in from..self.solid.len() {
            let Reflection { mirror, sign, .. } = self.solid[number];
            let stands_across =
                |&earlier: &usize| self.solid[earlier].mirror.is_across(&mirror, self.carrier);
            if !used.iter().all(stands_across) {
                continue;
            }
            let at = if used.is_empty() { mirror.image(&before.at) } else { mirror.again(&before.at) };
            let mut image = Image { at, factor: before.factor * sign * mirror.factor() };
            // Two walls that face each other go on mirroring by turns.
            let mut turn = number;
            for _ in 0..LONGEST_ROW {
                if image.factor.abs() < LEAST {
                    break;
                }
                self.plain.push(image);
                used.push(number);
                self.add_solid(number + 1, image, used);
                used.pop();
                let facing = |other: &usize| faces(&self.solid[turn].mirror, &self.solid[*other].mirror);
                let Some(next) = (0..self.solid.len()).find(facing) else { break };
                let Reflection { mirror, sign, .. } = self.solid[next];
                let factor = image.factor * sign * mirror.fade(mirror.distance_of(&image.at));
                image = Image { at: mirror.again(&image.at), factor };
                turn = next;
            }
        }
    }

    /// Adds the ghosts that screens make of the charge and its images.
    fn add_screens(&mut self, point: &Vector3<f64>) {
        let source = |image: &Image, is_charge| {
            let Image { at, factor } = *image;
            Source { at, factor, is_charge, bounds: [None; 2], hides: false }
        };
        self.sources.clear();
        self.sources.push(source(&Image { at: *point, factor: 1.0 }, true));
        self.sources.extend(self.plain.iter().map(|image| source(image, false)));
        let mut seen = vec![0; self.screens.len()];
        for round in 0..LONGEST_ROW {
            let before = self.sources.len();
            for (number, seen) in seen.iter_mut().enumerate() {
                let from = std::mem::replace(seen, self.sources.len());
                for index in from..self.sources.len() {
                    let source = self.sources[index];
                    let facing = source.bounds[0].is_some_and(|maker| {
                        faces(&self.screens[maker.screen].mirror, &self.screens[number].mirror)
                    });
                    // What one of two facing screens hides, the other does not meet.
                    if (round == 0 || facing) && !(facing && source.hides) {
                        self.reflect(number, &source);
                    }
                }
            }
            if self.sources.len() == before {
                break;
            }
        }
    }

    /// Adds the two ghosts that a screen makes of a source.
    fn reflect(&mut self, number: usize, source: &Source) {
        let Reflection { mirror, sign, .. } = self.screens[number];
        let Some(Screened { screen, extent }) = mirror.screened else { return };
        let distance = if source.is_charge { mirror.distance } else { mirror.distance_of(&source.at) };
        if distance < 0.0 || distance >= mirror.depth {
            return;
        }
        let fade = mirror.fade(distance);
        let is_curved = source.is_charge && mirror.curvature != 0.0;
        let curved = if is_curved { mirror.factor() / fade } else { 1.0 };
        let image = if is_curved { mirror.image(&source.at) } else { mirror.again(&source.at) };
        // A surface that bends so much that it does not part a charge from its image is replaced by its
        // tangent plane.
        let parts = screen.height(&source.at) > 0.0 && screen.height(&image) < 0.0;
        let screen = match screen {
            Screen::Curved(_) if !parts => Screen::Plane { normal: mirror.normal, offset: mirror.offset },
            screen => screen,
        };
        let others = source.bounds.iter().flatten().copied();
        let other: Vec<Bound> = others.clone().filter(|bound| bound.screen != number).collect();
        let is_hidden_already = others.clone().any(|bound| bound.screen == number);
        let bounds = [other.first().copied(), other.get(1).copied()];
        let confined = bounds.map(|bound| self.confined(bound));
        let hides = (source.at, -fade * source.factor, 1.0, true);
        let mirrors = (image, sign * fade * curved * source.factor, -1.0, false);
        for (at, factor, above, hides) in [hides, mirrors] {
            if factor.abs() < LEAST || (hides && is_hidden_already) {
                continue;
            }
            let shown = Shown::Behind { screen, above };
            self.ghosts.push(Ghost { at, charge: factor, extent, shown, confined });
            if bounds[1].is_none() {
                let made_by = Bound { screen: number, above: -above };
                let bounds = [Some(made_by), bounds[0]];
                self.sources.push(Source { at, factor, is_charge: false, bounds, hides });
            }
        }
    }
}

/// Whether two walls face each other.
fn faces(a: &Mirror, b: &Mirror) -> bool {
    a.normal.dot(&b.normal) < FACING
}
