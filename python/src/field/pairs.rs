//! The pairs of a field, kept as Rust has them; columns of the table are made when they are asked for.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use topo::{Kind, Pair, Scalar};

use super::number::{Number, as_float, threshold};
use crate::array::from_rows;

/// Pairs of any kind of numbers.
pub(crate) trait AnyPairs: Send + Sync {
    fn kind(&self) -> Kind;
    fn len(&self) -> usize;
    fn zero_count(&self) -> usize;
    fn columns<'py>(&self, py: Python<'py>, which: Which) -> PyResult<Columns<'py>>;
    fn diagram(&self) -> topo::Diagram;
}

/// Which pairs, and in which order.
pub(crate) enum Which {
    All,
    Ranked,
    Top(usize),
    Above(f64),
}

/// Extremum, saddle (-1 for none), birth, death, persistence.
pub(crate) type Columns<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyArray1<f64>>,
);

/// Birth and death of the finite pairs (n, 2), births of the essential classes.
type Points<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

impl<S: Number> AnyPairs for topo::Pairs<usize, S>
where
    S::Width: 'static,
{
    fn kind(&self) -> Kind {
        self.kind()
    }

    fn len(&self) -> usize {
        <[_]>::len(self)
    }

    fn zero_count(&self) -> usize {
        self.zero_count()
    }

    fn columns<'py>(&self, py: Python<'py>, which: Which) -> PyResult<Columns<'py>> {
        let chosen;
        let pairs: &[Pair<usize, S>] = match which {
            Which::All => self,
            Which::Ranked => {
                chosen = py.detach(|| self.ranked());
                &chosen
            }
            Which::Top(count) => {
                chosen = py.detach(|| self.top(count));
                &chosen
            }
            Which::Above(least) => {
                chosen = self.above(threshold::<S>(least)?).copied().collect::<Vec<_>>();
                &chosen
            }
        };
        Ok(columns(py, pairs, |vertex| vertex as i64))
    }

    fn diagram(&self) -> topo::Diagram {
        self.diagram()
    }
}

/// The columns of a table of pairs.
pub(crate) fn columns<'py, V: Copy, S: Number>(
    py: Python<'py>,
    pairs: &[Pair<V, S>],
    index: impl Fn(V) -> i64,
) -> Columns<'py> {
    (
        PyArray1::from_vec(py, pairs.iter().map(|pair| index(pair.extremum)).collect()),
        PyArray1::from_vec(py, pairs.iter().map(|pair| pair.saddle.map_or(-1, &index)).collect()),
        PyArray1::from_vec(py, pairs.iter().map(|pair| pair.birth).collect()).into_any(),
        PyArray1::from_vec(py, pairs.iter().map(Pair::end).collect()).into_any(),
        PyArray1::from_vec(py, pairs.iter().map(|pair| as_float(&pair.persistence())).collect()),
    )
}

/// [`topo::Pairs`].
#[pyclass(frozen, module = "cones._cones")]
pub(crate) struct Pairs(pub(crate) Box<dyn AnyPairs>);

impl Pairs {
    pub(crate) fn new<S: Number>(pairs: topo::Pairs<usize, S>) -> Self
    where
        <S as Scalar>::Width: 'static,
    {
        Self(Box::new(pairs))
    }
}

#[pymethods]
impl Pairs {
    #[getter]
    fn is_superlevel(&self) -> bool {
        self.0.kind() == Kind::Maximum
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    #[getter]
    fn zero_count(&self) -> usize {
        self.0.zero_count()
    }

    fn all<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.0.columns(py, Which::All)
    }

    fn ranked<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.0.columns(py, Which::Ranked)
    }

    fn top<'py>(&self, py: Python<'py>, count: usize) -> PyResult<Columns<'py>> {
        self.0.columns(py, Which::Top(count))
    }

    fn above<'py>(&self, py: Python<'py>, threshold: f64) -> PyResult<Columns<'py>> {
        self.0.columns(py, Which::Above(threshold))
    }

    /// Birth and death of the finite pairs, births of the essential classes.
    fn diagram<'py>(&self, py: Python<'py>) -> PyResult<Points<'py>> {
        let topo::Diagram { finite, essential, .. } = py.detach(|| self.0.diagram());
        let points = finite.into_iter().map(|(birth, death)| [birth, death]).collect();
        Ok((from_rows(py, points)?, PyArray1::from_vec(py, essential)))
    }
}
