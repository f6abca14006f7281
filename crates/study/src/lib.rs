//! Runs methods, checks the answer, then records the time; reports, plots and pictures.
