//! Sections `[contacts]`, `[charge_transfer]`, `[solver]` and `[output]`.

use super::description::{ChargeTransferSettings, OpenFoamSettings, OutputSettings, SolverLoss};
use crate::SceneError;
use crate::source::SceneSource;
use crate::table::SceneTable;
use amberfield_core::{Cohesion, RollingModel};

/// Models of contacts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactModels {
    pub(super) rolling: RollingModel,
    pub(super) cohesion: Cohesion,
}

/// Reads `[contacts]`.
pub(super) fn read_contacts(document: &SceneTable<'_>) -> Result<ContactModels, SceneError> {
    let Some(table) = document.table("contacts")? else { return Ok(Default::default()) };
    let rolling = RollingModel::ALL.map(|model| (model.name(), model));
    let cohesion = Cohesion::ALL.map(|model| (model.name(), model));
    Ok(ContactModels {
        rolling: table.word("rolling_model", &rolling)?.unwrap_or_default(),
        cohesion: table.word("cohesion", &cohesion)?.unwrap_or_default(),
    })
}

/// Reads `[charge_transfer]`.
pub(super) fn read_charge_transfer(
    document: &SceneTable<'_>,
) -> Result<Option<ChargeTransferSettings>, SceneError> {
    let Some(table) = document.table("charge_transfer")? else { return Ok(None) };
    Ok(Some(ChargeTransferSettings {
        beyond_previous_maximum: table.boolean("beyond_previous_maximum")?.unwrap_or(false),
        breakdown_field_v_m: table.number("breakdown_field_V_m")?,
        stiffness_correction: table.boolean("stiffness_correction")?.unwrap_or(false),
        velocity_ratio: table.number("velocity_ratio")?.unwrap_or(1.0),
    }))
}

/// Reads `[solver]`.
pub(super) fn read_solver(
    document: &SceneTable<'_>,
    source: &SceneSource,
) -> Result<Option<OpenFoamSettings>, SceneError> {
    let Some(table) = document.table("solver")? else { return Ok(None) };
    let case = table.text("openfoam_case")?;
    let case = table.need(case, "openfoam_case", "name the folder with 0/, constant/ and system/")?;
    let folder = source.path(case);
    if !folder.is_dir() {
        return Err(
            table.bad("openfoam_case", "no such folder; name the folder with 0/, constant/ and system/")
        );
    }
    let ranks = table.integer("ranks")?.unwrap_or(1);
    let hosts = table.text("hosts")?.map(|name| source.path(name));
    if hosts.is_some() && ranks == 1 {
        return Err(
            table.bad("hosts", "a solver of one rank is on this machine; give ranks, or remove hosts")
        );
    }
    if hosts.as_ref().is_some_and(|file| !file.is_file()) {
        return Err(
            table.bad("hosts", "no such file; name one with a machine in each line, as mpirun takes it")
        );
    }
    let losses = [("stop", SolverLoss::Stop), ("fallback", SolverLoss::Fallback), ("wait", SolverLoss::Wait)];
    Ok(Some(OpenFoamSettings {
        openfoam_case: folder,
        application: table.text("application")?.map(str::to_owned),
        start: table.boolean("start")?.unwrap_or(true),
        ranks: u32::try_from(ranks).expect("the range ends at 65536"),
        hosts,
        timeout_s: table.number("timeout_s")?.unwrap_or(30.0),
        wait_s: table.number("wait_s")?,
        on_solver_loss: table.word("on_solver_loss", &losses)?.unwrap_or_default(),
    }))
}

/// Reads `[output]`.
pub(super) fn read_output(document: &SceneTable<'_>) -> Result<OutputSettings, SceneError> {
    let mut output = OutputSettings::default();
    let Some(table) = document.table("output")? else { return Ok(output) };
    output.every_s = table.number("every_s")?;
    output.history_every_s = table.number("history_every_s")?;
    output.checkpoint_every_s = table.number("checkpoint_every_s")?;
    if let Some(formats) = table.words("formats")? {
        (output.vtk, output.csv, output.png) =
            (formats.contains(&"vtk"), formats.contains(&"csv"), formats.contains(&"png"));
    }
    Ok(output)
}
