//! The C library of amberfield. OpenFOAM's side sees the DEM process through it, and a DEM code of your own
//! gets the field from it. No call panics or throws; errors come as a status, with a text in the handle.
//!
//! `include/amberfield.h` is made of this crate by `cargo xtask header`; a test fails when it is stale.

mod charge_laws;
mod field_flow;
mod field_letters;
mod field_potentials;
mod field_question;
mod field_side;
mod foreign;
mod host;
mod host_gathered;
mod host_parameters;
mod host_ranks;
mod host_settings;
mod host_side;
mod status;

pub use charge_laws::{
    AmberfieldContact, amberfield_area_correction, amberfield_charge_between_grains,
    amberfield_charge_to_grounded_wall, amberfield_charge_to_insulating_wall, amberfield_contact_area,
    amberfield_coulomb, amberfield_kept_charge_field, amberfield_relaxation,
};
pub use field_flow::{
    AmberfieldFlow, amberfield_field_grains, amberfield_field_reply_flow, amberfield_field_reply_state,
    amberfield_field_state,
};
pub use field_letters::{
    AmberfieldLetter, AmberfieldProxy, amberfield_field_deliver, amberfield_field_letter,
    amberfield_field_open_distant, amberfield_field_run, amberfield_proxy_close, amberfield_proxy_error,
    amberfield_proxy_open, amberfield_proxy_send, amberfield_proxy_wait, amberfield_run_is_here,
};
pub use field_potentials::{amberfield_field_reply_potentials, amberfield_field_times};
pub use field_question::{AmberfieldQuestion, AmberfieldRequest};
pub use field_side::{
    AmberfieldFar, AmberfieldField, AmberfieldMesh, amberfield_field_boundary, amberfield_field_close,
    amberfield_field_density, amberfield_field_error, amberfield_field_fail, amberfield_field_guess,
    amberfield_field_open, amberfield_field_refuse, amberfield_field_reply, amberfield_field_send_mesh,
    amberfield_field_wait,
};
pub use host::AmberfieldHost;
pub use host_parameters::{
    amberfield_host_measured_error, amberfield_host_parameters, amberfield_host_recheck,
    amberfield_host_use_parameters,
};
pub use host_ranks::{AmberfieldExchange, AmberfieldRanks, AmberfieldSum};
pub use host_settings::{AmberfieldBoundary, AmberfieldFace, AmberfieldHostSettings};
pub use host_side::{
    amberfield_host_close, amberfield_host_energy, amberfield_host_error, amberfield_host_field,
    amberfield_host_open, amberfield_host_open_over_ranks, amberfield_host_retune,
};
pub use status::AmberfieldStatus;
