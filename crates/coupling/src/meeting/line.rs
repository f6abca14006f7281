//! A field process's way to the DEM process: the run's memory, or letters that the program carries.

use super::link::{Link, Message, SideOf};
use super::run_root::RunRoot;
use crate::CouplingError;
use amberfield_wire::{Block64, Header, Layout, Letter, Section, WireError};
use std::mem::MaybeUninit;
use std::time::{Duration, Instant};

/// Sender of the letters.
const PEER: &str = "DEM process";

/// Way of a rank's messages.
#[derive(Debug)]
pub(crate) enum Line {
    /// The run's memory, which the rank's machine has.
    Memory(Box<Place>),
    /// Letters, to and from a rank on the DEM process's machine.
    Letters(Mailbox),
}

/// The run's memory, as one rank has it open.
#[derive(Debug)]
pub(crate) struct Place {
    pub(crate) link: Link,
    // Dropped after the link.
    root: RunRoot,
}

/// Letters of a rank that cannot see the run's memory: one that came, one that is to go.
#[derive(Debug)]
pub(crate) struct Mailbox {
    run: u64,
    came: Option<Letter>,
    goes: Option<Letter>,
}

impl Place {
    /// Opens the memory of a run for one of so many ranks.
    pub(crate) fn open(
        root: RunRoot,
        rank: u32,
        ranks: u32,
        deadline: Instant,
    ) -> Result<Self, CouplingError> {
        root.check_version().map_err(|error| CouplingError::Wire { peer: PEER, error })?;
        let link = Link::new(&root, SideOf::Field { rank }, ranks, deadline)?;
        Ok(Self { link, root })
    }

    /// The next message, once it is there. Where the DEM process is gone its memory is removed at the end.
    pub(crate) fn receive(&mut self, timeout: Duration) -> Result<Message, CouplingError> {
        let Self { link, root } = self;
        let received = link.receive(0, timeout, || link.dem_is_alive());
        if matches!(received, Err(CouplingError::Lost { .. })) {
            root.inherit();
        }
        received
    }

    /// Name of the run.
    pub(crate) fn name(&self) -> &str {
        self.root.name()
    }
}

impl Mailbox {
    /// Takes a letter in, for the next look.
    pub(crate) fn deliver(&mut self, letter: Letter) {
        self.came = Some(letter);
    }

    /// Hands out the letter that is to go, if there is one.
    pub(crate) fn collect(&mut self) -> Option<Letter> {
        self.goes.take()
    }
}

impl Line {
    /// A line by letters, for a run of a name.
    pub(crate) fn letters(run: &str) -> Result<Self, CouplingError> {
        Ok(Self::Letters(Mailbox { run: RunRoot::number_of(run)?, came: None, goes: None }))
    }

    /// The run's number.
    pub(crate) fn run(&self) -> u64 {
        match self {
            Self::Memory(place) => place.link.run(),
            Self::Letters(mailbox) => mailbox.run,
        }
    }

    /// Whether arrays by cell hold those of all ranks; else this rank's alone.
    pub(crate) fn has_all_ranks(&self) -> bool {
        matches!(self, Self::Memory(_))
    }

    /// Sends a message: `write` fills its sections in place.
    pub(crate) fn send(
        &mut self,
        layout: &Layout,
        write: impl FnOnce(&mut [MaybeUninit<Block64>]) -> Result<(), WireError>,
    ) -> Result<(), CouplingError> {
        match self {
            Self::Memory(place) => place.link.send(layout, 1, write),
            Self::Letters(mailbox) => {
                let letter = Letter::write(layout, write);
                mailbox.goes = Some(letter.map_err(|error| CouplingError::Wire { peer: "own side", error })?);
                Ok(())
            }
        }
    }

    /// Says that this was the last message, and why. Returns whether somebody in the run's memory has it.
    pub(crate) fn end(&mut self, header: Header, why: &str) -> bool {
        let layout = Layout::new(header).with::<u8>(Section::Text, why.len());
        let sent = self.send(&layout, |payload| {
            layout.section_mut::<u8>(payload, Section::Text)?.copy_from_slice(why.as_bytes());
            Ok(())
        });
        sent.is_ok() && matches!(self, Self::Memory(_))
    }

    /// The next message: by memory once it is there, by letters the one that was delivered.
    pub(crate) fn receive(&mut self) -> Result<Message, CouplingError> {
        match self {
            Self::Memory(place) => place.receive(Duration::MAX),
            Self::Letters(mailbox) => match mailbox.came.take() {
                Some(letter) => Message::Letter(letter).unless_last(PEER, mailbox.run),
                None => Err(CouplingError::SharedMemory("no letter has been delivered".into())),
            },
        }
    }
}
