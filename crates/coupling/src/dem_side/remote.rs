//! The process that solves, as the DEM side sees it: one question at a time, an answer of every rank.

use super::launch::Process;
use super::settings::SolverSettings;
use crate::CouplingError;
use crate::meeting::Link;
use crate::meeting::RunRoot;
use amberfield_wire::{Block64, Header, Layout, MessageKind, Sections, WireError};
use std::mem::MaybeUninit;
use std::ops::Range;

/// A process that solves, with all its ranks.
#[derive(Debug)]
pub(super) struct Remote {
    pub(super) settings: SolverSettings,
    /// First cell of each rank, and the number of all.
    first: Vec<usize>,
    /// Number of the last question.
    solve: u64,
    /// Whether the last question was answered.
    healthy: bool,
    // Dropped in this order: the link says goodbye, the process ends, the run's place goes.
    link: Link,
    process: Option<Process>,
    _root: RunRoot,
}

impl Remote {
    /// A process whose ranks have so many cells.
    pub(super) fn new(
        settings: SolverSettings,
        cells: &[usize],
        (link, process, root): (Link, Option<Process>, RunRoot),
    ) -> Self {
        let mut first = vec![0];
        for cells in cells {
            first.push(first[first.len() - 1] + cells);
        }
        Self { settings, first, solve: 0, healthy: true, link, process, _root: root }
    }

    /// Cells of all ranks.
    pub(super) fn cell_count(&self) -> usize {
        self.first[self.first.len() - 1]
    }

    /// Asks without waiting: `layout` adds sections to a header, `write` fills them.
    pub(super) fn ask(
        &mut self,
        kind: MessageKind,
        layout: impl FnOnce(Layout) -> Layout,
        write: impl FnOnce(&Layout, &mut [MaybeUninit<Block64>]) -> Result<(), WireError>,
    ) -> Result<(), CouplingError> {
        // Potentials are asked for beside a solve, and are there at once.
        self.solve += u64::from(kind != MessageKind::Times);
        let layout = layout(Layout::new(Header::new(kind, self.link.run(), self.solve)));
        let outcome =
            self.link.send(&layout, self.settings.ranks as usize, |payload| write(&layout, payload));
        self.noted(outcome)
    }

    /// Waits for every rank's answer to what was asked last: `take` gets the cells that are the rank's, its
    /// number and what it says.
    pub(super) fn collect(
        &mut self,
        kind: MessageKind,
        mut take: impl FnMut(Range<usize>, usize, &Sections<'_>) -> Result<(), WireError>,
    ) -> Result<(), CouplingError> {
        let mut missing = self.settings.ranks;
        let mut seen = vec![false; missing as usize];
        while missing > 0 {
            let process = &mut self.process;
            let patience = self.settings.patience(self.solve);
            let received = self.link.receive(self.solve, patience, || alive(process));
            let taken = received.and_then(|message| {
                let header = message.header();
                check_sender(header, self.settings.ranks, kind, self.solve).map_err(of_solver)?;
                let rank = header.rank as usize;
                take(self.first[rank]..self.first[rank + 1], rank, &message.sections()).map_err(of_solver)?;
                Ok(rank)
            });
            let rank = self.noted(taken)?;
            missing -= u32::from(!std::mem::replace(&mut seen[rank], true));
        }
        Ok(())
    }

    /// Notes whether an exchange went well, which decides how the solver is told to end.
    pub(super) fn noted<T>(&mut self, outcome: Result<T, CouplingError>) -> Result<T, CouplingError> {
        self.healthy = outcome.is_ok();
        outcome
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        let header = Header::new(MessageKind::End, self.link.run(), self.solve);
        let said = self.link.end(header, self.settings.ranks as usize, "the run is over");
        if let Some(process) = &mut self.process {
            process.end(said.is_ok() && self.healthy);
        }
    }
}

/// Whether a process of ours still runs.
pub(super) fn alive(process: &mut Option<Process>) -> Result<(), String> {
    process.as_mut().map_or(Ok(()), Process::check)
}

/// Error about a message of the solver.
pub(super) fn of_solver(error: WireError) -> CouplingError {
    CouplingError::Wire { peer: "field solver", error }
}

/// Refuses a message of another kind, of another solve, or of a rank that there is not.
pub(super) fn check_sender(
    header: &Header,
    ranks: u32,
    kind: MessageKind,
    solve: u64,
) -> Result<(), WireError> {
    let fits = header.kind == kind as u32 && header.solve == solve;
    if !fits || header.rank >= ranks || header.ranks != ranks {
        return Err(WireError::Unexpected {
            kind: header.kind,
            solve: header.solve,
            rank: header.rank,
            ranks: header.ranks,
        });
    }
    Ok(())
}
