//! Traces of a launcher that started this program as a rank of MPI: no program that this one starts may take
//! them for its own.
//!
//! MPICH's launcher gives each rank a socket and its number in variables; a program that inherits them is the
//! rank twice. Open MPI's refuses to start anything from within a rank of its own.

use rustix::io::{FdFlags, fcntl_setfd};
use std::os::fd::{BorrowedFd, RawFd};
use std::os::unix::process::CommandExt as _;
use std::process::Command;

/// Beginnings of the variables in which launchers tell a rank who it is. What a user sets for MPI stays, such
/// as `OMPI_MCA_plm`, and what Slurm says of a job and its machines.
const OF_A_RANK: [&str; 34] = [
    // MPICH and its relatives
    "HYDI_",
    "MPI_LOCALNRANKS",
    "MPI_LOCALRANKID",
    "PMI_",
    "PMI2_",
    // Open MPI
    "OMPI_APP_CTX_",
    "OMPI_ARGV",
    "OMPI_COMMAND",
    "OMPI_COMM_WORLD_",
    "OMPI_FILE_LOCATION",
    "OMPI_FIRST_RANKS",
    "OMPI_MCA_ess",
    "OMPI_MCA_initial_wdir",
    "OMPI_MCA_mpi_oversubscribe",
    "OMPI_MCA_orte_",
    "OMPI_MCA_pmix",
    "OMPI_MCA_rmaps_base_oversubscribe",
    "OMPI_MCA_shmem_RUNTIME_QUERY_hint",
    "OMPI_NUM_APP_CTX",
    "OMPI_UNIVERSE_SIZE",
    "PMIX_",
    // A step of a job of Slurm's
    "SLURM_CPU_BIND",
    "SLURM_DISTRIBUTION",
    "SLURM_GTIDS",
    "SLURM_LAUNCH_NODE_IPADDR",
    "SLURM_LOCALID",
    "SLURM_MPI_TYPE",
    "SLURM_NODEID",
    "SLURM_PMI",
    "SLURM_PROCID",
    "SLURM_SRUN_COMM_",
    "SLURM_STEPID",
    "SLURM_STEP_",
    "SLURM_TASK_PID",
];
/// Folder with this process's open descriptors.
const DESCRIPTORS: &str = "/proc/self/fd";

/// Hides from a program that is to be started that a launcher started this one: its variables, and all
/// descriptors but the standard three.
pub(super) fn hide_launcher(command: &mut Command) {
    for (name, _) in std::env::vars_os() {
        if name.to_str().is_some_and(is_of_a_rank) {
            command.env_remove(name);
        }
    }
    let inherited = open_descriptors();
    let close = move || {
        for &descriptor in &inherited {
            // SAFETY: any number may be asked about; that of nothing open gives an error.
            let descriptor = unsafe { BorrowedFd::borrow_raw(descriptor) };
            let _ = fcntl_setfd(descriptor, FdFlags::CLOEXEC);
        }
        Ok(())
    };
    // SAFETY: between fork and exec the closure makes system calls only; it neither locks nor allocates.
    unsafe { command.pre_exec(close) };
}

fn is_of_a_rank(name: &str) -> bool {
    OF_A_RANK.iter().any(|beginning| name.starts_with(beginning))
}

/// Numbers of the open descriptors behind the standard ones.
fn open_descriptors() -> Vec<RawFd> {
    let entries = std::fs::read_dir(DESCRIPTORS).into_iter().flatten().flatten();
    let numbers = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<RawFd>().ok());
    numbers.filter(|&number| number > 2).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::fd::AsRawFd as _;

    #[test]
    fn a_rank_is_known_by_its_variables_and_a_users_stay() {
        for name in ["PMI_FD", "HYDI_CONTROL_FD", "OMPI_COMM_WORLD_RANK", "PMIX_RANK", "SLURM_PROCID"] {
            assert!(is_of_a_rank(name), "{name}");
        }
        for name in ["PATH", "OMPI_MCA_plm", "OMPI_MCA_ras", "SLURM_JOB_NODELIST", "SLURM_JOB_ID"] {
            assert!(!is_of_a_rank(name), "{name}");
        }
    }

    #[test]
    fn a_program_inherits_no_descriptor() {
        let file = std::fs::File::open("/dev/null").unwrap();
        fcntl_setfd(&file, FdFlags::empty()).unwrap();
        let number = file.as_raw_fd();
        let sees = |hide: bool| {
            let mut command = Command::new("test");
            command.args(["-e", &format!("{DESCRIPTORS}/{number}")]);
            if hide {
                hide_launcher(&mut command);
            }
            command.status().unwrap().success()
        };
        assert!(sees(false), "the test makes one that is inherited");
        assert!(!sees(true));
    }
}
