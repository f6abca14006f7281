//! Books of a run: what is inside is what was there at the start and what came, less what left.

use super::Simulation;
use crate::books::Tally;

/// Books of the grains of one material, or of all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Book {
    /// Grains at the start.
    pub start: Tally,
    /// Grains that came.
    pub fed: Tally,
    /// Grains that left.
    pub left: Tally,
    /// Grains that are there.
    pub inside: Tally,
    /// Charge that they gained at contacts with others and with walls [C].
    pub gained: f64,
}

impl Book {
    /// Difference between the charge inside and what the others say [C]: round-off.
    #[must_use]
    pub fn charge_off(&self) -> f64 {
        self.inside.charge - (self.start.charge + self.fed.charge - self.left.charge + self.gained)
    }

    /// Sum of books.
    #[must_use]
    pub fn sum(books: &[Self]) -> Self {
        let all = |of: fn(&Self) -> &Tally| Tally::sum(books.iter().map(of));
        Self {
            start: all(|book| &book.start),
            fed: all(|book| &book.fed),
            left: all(|book| &book.left),
            inside: all(|book| &book.inside),
            gained: books.iter().map(|book| book.gained).sum(),
        }
    }
}

impl Simulation {
    /// Books by material; `None` where grains neither come nor go.
    #[must_use]
    pub fn books(&self) -> Option<Vec<Book>> {
        let known = self.books.as_ref()?;
        let mut books: Vec<Book> = (0..known.start.len())
            .map(|material| Book {
                start: known.start[material],
                fed: known.state.fed[material],
                left: known.state.left[material],
                inside: Tally::default(),
                gained: self.charging.as_ref().map_or(0.0, |charging| charging.ledger.gained[material]),
            })
            .collect();
        // Added up in the order of the set-up, as the other sums are.
        let mut originals: Vec<usize> =
            self.grains.original.iter().map(|original| original.index()).collect();
        originals.sort_unstable();
        for original in originals {
            let (mass, charge) = (self.particles.mass(original), self.particles.charge[original]);
            books[usize::from(self.particles.material[original].0)].inside.add(mass, charge);
        }
        Some(books)
    }

    /// Grains that left through each outlet, by material; empty without outlets.
    #[must_use]
    pub fn outlets(&self) -> &[Vec<Tally>] {
        self.books.as_ref().map_or(&[], |books| &books.state.outlets)
    }
}
