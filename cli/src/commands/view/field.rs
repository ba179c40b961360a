//! A field on show: the page that `cones persistence --report` writes, served.

use super::ViewArgs;
use super::http::{Request, Response};
use crate::commands::persistence::{DomainField, PairList, Wanted, explain, html};
use crate::error::CommandError;
use crate::input::Form;
use topo::Kind;

/// Whether a field is to be seen, and not a surface with its maps.
pub(super) fn is_asked(args: &ViewArgs) -> bool {
    args.of.field.is_some() || matches!(Form::of(&args.of.input), Ok(Form::Array | Form::Network))
}

/// The page, with the extrema of both kinds.
pub(super) fn page(args: &ViewArgs) -> Result<String, CommandError> {
    if let Some(option) = args.candidates.first_given() {
        return Err(CommandError::Misplaced { path: args.of.input.clone(), option, of: "a surface" });
    }
    let of = &args.of;
    let subject = DomainField::read(of)?;
    let wanted = Wanted { options: of.options(), min_persistence: 0.0, top: None };
    let list = |kind| PairList::new(&subject, kind, &wanted).map_err(|error| explain(&subject.path, error));
    let (minima, maxima) = (list(Kind::Minimum)?, list(Kind::Maximum)?);
    html(&of.input, &subject, &[&minima, &maxima], of.options())
}

/// Answers with the page, which asks for nothing else.
pub(super) fn answer(page: &str, path: &str, request: &Request) -> Response {
    match (path, request.method.as_str()) {
        ("", "GET") => Response::new("text/html; charset=utf-8", page.as_bytes().to_vec()),
        ("", _) => Response::refusal(405, "this is asked for with GET"),
        _ => Response::refusal(404, "there is nothing here"),
    }
}
