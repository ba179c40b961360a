//! What is found once of components of the same shape: those that share what was found when they were made.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::component::Component;
use super::cones::Configuration;
use super::flat::Flat;
use super::observer::Times;
use crate::error::Error;
use crate::field::Operators;
use crate::placement::{Automatic, Nested};

/// What is found of a component and as true of others of its shape, once it is said of them.
pub(super) trait OfShape: Clone {
    /// The same of `other`, when it was found of `component`.
    fn said_of(&self, other: &Component, component: &Component) -> Self;
}

/// What names neither components nor vertices of the model.
macro_rules! of_any {
    ($($found:ty),*) => {
        $(impl OfShape for $found {
            fn said_of(&self, _: &Component, _: &Component) -> Self {
                self.clone()
            }
        })*
    };
}

of_any!((), Automatic, Nested);

impl OfShape for Configuration {
    fn said_of(&self, other: &Component, component: &Component) -> Self {
        Self { notes: other.own_notes(&self.notes, component), ..self.clone() }
    }
}

impl OfShape for Flat {
    fn said_of(&self, other: &Component, component: &Component) -> Self {
        let mut said = self.clone();
        said.notes = other.own_notes(&self.notes, component);
        said
    }
}

impl<T: OfShape> OfShape for Option<T> {
    fn said_of(&self, other: &Component, component: &Component) -> Self {
        self.as_ref().map(|found| found.said_of(other, component))
    }
}

impl<T: OfShape> OfShape for Result<T, Error> {
    fn said_of(&self, other: &Component, component: &Component) -> Self {
        self.as_ref().map(|found| found.said_of(other, component)).map_err(Error::clone)
    }
}

/// What there is of each component, found once of each shape, on several threads.
pub(super) fn of_shapes<T: Clone + Send>(
    components: &[Arc<Component>],
    find: impl Fn(&Arc<Component>) -> T + Send + Sync,
) -> Vec<T> {
    let mut place: HashMap<*const Operators, usize> = HashMap::new();
    let mut firsts = Vec::new();
    let places: Vec<usize> = components
        .iter()
        .map(|component| {
            *place.entry(Arc::as_ptr(&component.operators)).or_insert_with(|| {
                firsts.push(component);
                firsts.len() - 1
            })
        })
        .collect();
    let found: Vec<T> = firsts.into_par_iter().with_max_len(1).map(find).collect();
    places.into_iter().map(|place| found[place].clone()).collect()
}

/// Does the same with each component, on several threads; the first error in the components' order. The time on the clock
/// is added to `times`.
pub(super) fn each<T: Send>(
    components: &[Arc<Component>],
    times: &mut Times,
    work: impl Fn(&Component, &mut Times) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    let components: Vec<&Component> = components.iter().map(|component| &**component).collect();
    on_clock(&components, times, work).into_iter().collect()
}

/// The same with one component of each shape. `is_same` says of two components by their numbers whether what is done to them is the same.
pub(super) fn each_shape<T: OfShape + Send>(
    components: &[Arc<Component>],
    times: &mut Times,
    is_same: impl Fn(usize, usize) -> bool,
    work: impl Fn(&Component, &mut Times) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    // Of each component its place among those that are worked on.
    let mut place = Vec::with_capacity(components.len());
    let mut worked_on: Vec<&Component> = Vec::new();
    let mut of_shape: HashMap<*const Operators, Vec<usize>> = HashMap::new();
    for component in components {
        let others = of_shape.entry(Arc::as_ptr(&component.operators)).or_default();
        let found = others.iter().copied().find(|&other| is_same(worked_on[other].index, component.index));
        place.push(found.unwrap_or(worked_on.len()));
        if found.is_none() {
            others.push(worked_on.len());
            worked_on.push(component);
        }
    }
    let done = on_clock(&worked_on, times, work).into_iter().collect::<Result<Vec<T>, Error>>()?;
    let of_other = |(component, &at): (&Arc<Component>, &usize)| {
        (worked_on[at].index != component.index).then(|| done[at].said_of(component, worked_on[at]))
    };
    let of_others: Vec<Option<T>> = components.iter().zip(&place).map(of_other).collect();
    let mut own = done.into_iter();
    Ok(of_others.into_iter().filter_map(|found| found.or_else(|| own.next())).collect())
}

fn on_clock<T: Send>(
    components: &[&Component],
    times: &mut Times,
    work: impl Fn(&Component, &mut Times) -> Result<T, Error> + Sync,
) -> Vec<Result<T, Error>> {
    let began = Instant::now();
    let timed = |component: &&Component| {
        let mut times = Times::default();
        let done = work(component, &mut times);
        (done, times)
    };
    let done: Vec<(Result<T, Error>, Times)> = components.par_iter().with_max_len(1).map(timed).collect();
    *times += Times::on_clock(done.iter().map(|(_, times)| *times), began.elapsed());
    done.into_iter().map(|(done, _)| done).collect()
}
