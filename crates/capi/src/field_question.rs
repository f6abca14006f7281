//! Questions of the DEM process, as the field side gets them.

use amberfield_coupling::Question;
use amberfield_wire::payloads::{FarQuestion, FlowQuestion, SourceCloud};

/// Kind of question of the DEM process.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmberfieldQuestion {
    /// The far field: call density, boundary, guess, then reply.
    Field = 0,
    /// The flow at the end of an interval: call grains, then reply_flow.
    Flow = 1,
    /// The state of the flow: call reply_state.
    State = 2,
    /// A state of the flow to take in: call state, then reply_state with no number.
    Restore = 3,
    /// The potentials of patches that change, at some times: call times, then reply_potentials.
    Potentials = 4,
}

/// Question of the DEM process, with the scalars that belong to it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AmberfieldRequest {
    /// Kind of question.
    pub question: AmberfieldQuestion,
    /// Number of the solve.
    pub solve: u64,
    /// Number of times of the question for potentials that change; 0 for other questions.
    pub times: u64,
    /// The question for the far field; all 0 unless that is what is asked.
    pub far: FarQuestion,
    /// The question for the flow; all 0 unless that is what is asked.
    pub flow: FlowQuestion,
}

const NO_FAR_QUESTION: FarQuestion = FarQuestion {
    cloud: SourceCloud::nearest_cell(),
    permittivity_f_m: 0.0,
    neutralising_background: 0,
    time_s: 0.0,
    tolerance: 0.0,
    wants_e: 0,
};

const NO_FLOW_QUESTION: FlowQuestion = FlowQuestion {
    interval_s: 0.0,
    time_s: 0.0,
    density_kg_m3: 0.0,
    viscosity_pa_s: 0.0,
    model_b: 0,
    viscous_force: 0,
    vorticity: 0,
};

impl AmberfieldRequest {
    pub(crate) fn of(question: Question, solve: u64, times: u64) -> Self {
        let only = |question| Self { question, solve, times, far: NO_FAR_QUESTION, flow: NO_FLOW_QUESTION };
        match question {
            Question::Far(far) => Self { far, ..only(AmberfieldQuestion::Field) },
            Question::Flow(flow) => Self { flow, ..only(AmberfieldQuestion::Flow) },
            Question::State => only(AmberfieldQuestion::State),
            Question::Restore => only(AmberfieldQuestion::Restore),
            Question::Potentials => only(AmberfieldQuestion::Potentials),
        }
    }
}
