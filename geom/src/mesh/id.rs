//! Typed indices, and arrays indexed by them.
//!
//! An index is a `u32`, because memory traffic is the cost of everything done with meshes.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut, Index, IndexMut};

/// A typed index: a newtype of `u32` that can be turned into a position in an array.
pub trait Id: Copy + Eq + Ord {
    /// The id of the element at `index`.
    fn new(index: usize) -> Self;
    /// The position of this element.
    fn index(self) -> usize;
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $data:ident, $element:literal, $letter:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(pub u32);

        impl Id for $name {
            #[inline]
            fn new(index: usize) -> Self {
                debug_assert!(index < u32::MAX as usize);
                Self(index as u32)
            }
            #[inline]
            fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}{}", $letter, self.0)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}", self.0)
            }
        }

        #[doc = concat!("A value for each ", $element, ".")]
        pub type $data<T> = Data<$name, T>;
    };
}

id!(
    /// A vertex.
    VertexId, VertexData, "vertex", "v"
);
id!(
    /// An (undirected) edge.
    EdgeId, EdgeData, "edge", "e"
);
id!(
    /// A triangle.
    FaceId, FaceData, "face", "f"
);
id!(
    /// A halfedge: a side of a triangle, directed counter-clockwise round it. It also names the triangle's corner at
    /// its tail.
    HalfedgeId, HalfedgeData, "halfedge", "h"
);
id!(
    /// A vertex of a mesh that was opened along edges: the corners at one vertex between two cuts.
    WedgeId, WedgeData, "wedge", "w"
);

/// An array with a value for each element that an id type names. It is a slice with typed indexing.
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(transparent, bound(serialize = "T: serde::Serialize", deserialize = "T: serde::Deserialize<'de>"))
)]
pub struct Data<I, T> {
    values: Vec<T>,
    id: PhantomData<I>,
}

impl<I: Id, T> Data<I, T> {
    /// The same value for each of `count` elements.
    pub fn constant(count: usize, value: T) -> Self
    where
        T: Clone,
    {
        vec![value; count].into()
    }

    /// The ids with their values.
    pub fn iter_ids(&self) -> impl Iterator<Item = (I, &T)> {
        self.values.iter().enumerate().map(|(index, value)| (I::new(index), value))
    }

    /// The values without their ids.
    pub fn into_vec(self) -> Vec<T> {
        self.values
    }
}

impl<I, T> From<Vec<T>> for Data<I, T> {
    fn from(values: Vec<T>) -> Self {
        Self { values, id: PhantomData }
    }
}

impl<I, T> FromIterator<T> for Data<I, T> {
    fn from_iter<It: IntoIterator<Item = T>>(values: It) -> Self {
        values.into_iter().collect::<Vec<_>>().into()
    }
}

impl<I: Id, T> Index<I> for Data<I, T> {
    type Output = T;
    #[inline]
    fn index(&self, id: I) -> &T {
        &self.values[id.index()]
    }
}

impl<I: Id, T> IndexMut<I> for Data<I, T> {
    #[inline]
    fn index_mut(&mut self, id: I) -> &mut T {
        &mut self.values[id.index()]
    }
}

impl<I, T> Deref for Data<I, T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        &self.values
    }
}

impl<I, T> DerefMut for Data<I, T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values
    }
}

impl<I, T: fmt::Debug> fmt::Debug for Data<I, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.values.fmt(f)
    }
}
