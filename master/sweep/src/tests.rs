//! Plans and whole sweeps on a short line.
