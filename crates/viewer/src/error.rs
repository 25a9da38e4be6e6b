//! Why a page cannot be served.

use std::io;
use std::net::SocketAddr;

/// Why a page cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// The address is taken, or not this machine's.
    #[error("cannot listen at {address}: {source}; give another port, or 0 for any that is free")]
    Listen {
        /// What was asked for.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// A token that cannot stand in an address as it is, or that everybody knows.
    #[error(
        "a token must be letters, digits, `-` and `_`, at least one; leave it out for a random one, or none"
    )]
    Token,
    /// No thread, or no socket, can be had.
    #[error("the server cannot run: {0}")]
    Run(#[from] io::Error),
}
