//! The process that solves for the far field and for a flow, and the questions that are open.

use super::remote::Remote;
use crate::CouplingError;
use amberfield_core::Vector3;
use amberfield_field::far::FarValues;
use amberfield_gas::FlowValues;
use amberfield_wire::payloads::FlowQuestion;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Question that is being answered while the grains move on.
#[derive(Debug)]
pub(super) struct Pending<Known, Answer> {
    /// Facts of the open question that its answer needs.
    pub(super) asked: Option<Known>,
    /// Answer that came early, because the other level asked next.
    pub(super) answer: Option<Answer>,
}

impl<Known, Answer> Pending<Known, Answer> {
    /// Nothing is asked, nothing came.
    pub(super) const NOTHING: Self = Self { asked: None, answer: None };
}

/// Facts of an open question for the far field.
#[derive(Clone, Copy, Debug)]
pub(super) struct AskedFar {
    /// Number of charges.
    pub(super) charges: usize,
    /// Whether E is wanted at the cells' centres.
    pub(super) wants_e: bool,
}

/// Process that solves for the far field, for the flow of a gas, or for both.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) remote: Remote,
    /// Far field, with what it was asked for.
    pub(super) far: Pending<AskedFar, FarValues>,
    /// Flow, with its question.
    pub(super) flow: Pending<FlowQuestion, FlowValues>,
}

impl Shared {
    /// Takes the answers to all open questions, before the next is asked: messages come in the order of their
    /// questions.
    pub(super) fn clear_the_way(&mut self) -> Result<(), CouplingError> {
        if self.far.asked.is_some() {
            let mut values = FarValues::default();
            self.take_far(&mut values)?;
            self.far.answer = Some(values);
        }
        self.take_flow_early()
    }
}

/// The process that both handles share. A panic in one handle leaves nothing half done that the next exchange
/// would not notice.
pub(super) fn locked(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Copies vectors into a message.
pub(super) fn write_vectors(into: &mut [[f64; 3]], from: &[Vector3<f64>]) {
    for (into, from) in into.iter_mut().zip(from) {
        *into = (*from).into();
    }
}

/// Copies vectors from a message.
pub(super) fn read_vectors(into: &mut [Vector3<f64>], from: &[[f64; 3]]) {
    for (into, from) in into.iter_mut().zip(from) {
        *into = Vector3::from(*from);
    }
}
