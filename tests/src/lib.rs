//! What the laws across the crates are stated with.
//!
//! Each law is a function of bytes ([`properties`]): proptest drives it with random ones in `cargo test`, cargo-fuzz with
//! those that reach new code, and what either found once is replayed from files ever after. The bytes are read as small
//! inputs of the kind that hurts ([`decode`], [`encode`]) on the simplest [`solids`], and what comes out is compared with slow,
//! independent ways to the same answer ([`oracle`]).

#![allow(clippy::missing_panics_doc, reason = "a law panics where it does not hold")]

pub mod decode;
pub mod encode;
pub mod noise;
pub mod oracle;
pub mod properties;
pub mod solids;

/// The examples of README.md, run as they stand there.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// The examples in Rust of the tutorials. Their Python and their commands are run by `python/tests/test_docs.py`.
#[cfg(doctest)]
pub mod tutorials {
    #[doc = include_str!("../../docs/tutorials/scan.md")]
    pub struct Scan;
    #[doc = include_str!("../../docs/tutorials/peaks.md")]
    pub struct Peaks;
    #[doc = include_str!("../../docs/tutorials/network.md")]
    pub struct Network;
    #[doc = include_str!("../../docs/tutorials/volume.md")]
    pub struct Volume;
}
