//! Errors as exceptions, with the sentences that the command prints.

use std::error::Error as StdError;

use pyo3::create_exception;
use pyo3::exceptions::{PyFileNotFoundError, PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;

create_exception!(cones, Error, PyValueError, "Something that was asked for cannot be had; the message says why.");

/// An error on its way to Python.
pub(crate) struct Failed<E>(pub(crate) E);

/// An error and what caused it, in one line.
fn sentence(error: &dyn StdError) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let of_cause = error.to_string();
        if !text.ends_with(&of_cause) {
            text = format!("{text}: {of_cause}");
        }
        cause = error.source();
    }
    text
}

/// The exception of an error that is about what was given.
pub(crate) fn exception(error: &dyn StdError) -> PyErr {
    Error::new_err(sentence(error))
}

impl From<Failed<cones::Error>> for PyErr {
    fn from(Failed(error): Failed<cones::Error>) -> Self {
        match error {
            cones::Error::Interrupted => PyKeyboardInterrupt::new_err(()),
            error => exception(&error),
        }
    }
}

impl From<Failed<geom::distortion::DistortionError>> for PyErr {
    fn from(Failed(error): Failed<geom::distortion::DistortionError>) -> Self {
        match error {
            geom::distortion::DistortionError::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            error => exception(&error),
        }
    }
}

impl From<Failed<geom::io::ReadError>> for PyErr {
    fn from(Failed(error): Failed<geom::io::ReadError>) -> Self {
        match error.problem() {
            geom::io::Problem::Missing => PyFileNotFoundError::new_err(sentence(&error)),
            _ => exception(&error),
        }
    }
}

macro_rules! from {
    ($($error:ty),*) => {
        $(impl From<Failed<$error>> for PyErr {
            fn from(Failed(error): Failed<$error>) -> Self {
                exception(&error)
            }
        })*
    };
}

from!(geom::ModelError, geom::PrepareError, geom::io::WriteError, cones::uv::PackError, topo::Error);
