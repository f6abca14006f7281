//! A rank on another machine, as the run's memory sees it.

use super::question::Question;
use super::share::Share;
use super::side::{FieldSide, OPENING, of_dem};
use crate::CouplingError;
use crate::meeting::{Place, RunRoot};
use crate::mesh::MeshPart;
use amberfield_wire::{Letter, MessageKind, WireError};
use std::time::Instant;

/// Stands in the run's memory for a rank on a machine that has it not. The program carries letters between
/// both; the DEM process sees no difference.
#[derive(Debug)]
pub struct Proxy {
    place: Place,
    rank: u32,
    ranks: u32,
    /// The rank's share of questions, once its mesh has come.
    share: Option<Share>,
}

impl Proxy {
    /// Opens a run by its name, in the place of one of so many ranks.
    ///
    /// # Errors
    /// No such run, no shared memory.
    pub fn open(run: &str, rank: u32, ranks: u32) -> Result<Self, CouplingError> {
        let place = Place::open(RunRoot::open(run)?, rank, ranks, Instant::now() + OPENING)?;
        Ok(Self { place, rank, ranks, share: None })
    }

    /// Sends what the rank has to say.
    ///
    /// # Errors
    /// Bytes that are no message of this rank's, a DEM process that is gone.
    pub fn send(&mut self, bytes: &[u8]) -> Result<(), CouplingError> {
        let of_rank = |error| CouplingError::Wire { peer: "rank on another machine", error };
        let letter = Letter::from_bytes(bytes).map_err(of_rank)?;
        let header = letter.header();
        let kind = header.check(self.place.link.run()).map_err(of_rank)?;
        if (header.rank, header.ranks) != (self.rank, self.ranks) {
            let (kind, solve, rank, ranks) = (header.kind, header.solve, header.rank, header.ranks);
            return Err(of_rank(WireError::Unexpected { kind, solve, rank, ranks }));
        }
        if kind == MessageKind::Mesh {
            let part = MeshPart::read(&letter.sections()).map_err(of_rank)?;
            self.share = Some(Share::new(&part, self.rank)?);
        }
        self.place.link.send_letter(&letter)
    }

    /// Waits for the next question, and gives the rank's share of it; `None` when the run is over.
    ///
    /// # Errors
    /// A DEM process that is gone, a message that makes no sense.
    pub fn wait(&mut self) -> Result<Option<Letter>, CouplingError> {
        let message = match self.place.receive(OPENING) {
            Ok(message) => message,
            Err(CouplingError::Ended { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        let share = self.share.as_mut().ok_or_else(super::side::no_mesh)?;
        let question = Question::read(message.header(), &message.sections()).map_err(of_dem)?;
        share.of(&question, &message).map(Some).map_err(of_dem)
    }
}

/// Letters of a rank on another machine.
impl FieldSide {
    /// Takes in what the rank's proxy gave, before it is waited for.
    ///
    /// # Errors
    /// Bytes that are no message, a rank that sees the run's memory itself.
    pub fn deliver(&mut self, bytes: &[u8]) -> Result<(), CouplingError> {
        let letter = Letter::from_bytes(bytes).map_err(of_dem)?;
        self.mailbox().ok_or_else(no_letters)?.deliver(letter);
        Ok(())
    }

    /// Hands out what the last call left to be carried to the rank's proxy; `None` where that is nothing.
    pub fn letter(&mut self) -> Option<Letter> {
        self.mailbox()?.collect()
    }
}

fn no_letters() -> CouplingError {
    CouplingError::SharedMemory("this rank sees the run's memory and takes no letters".into())
}
