//! What the page is told: the surface once, then cones and maps as it asks for them.

use super::http::{Request, Response};
use super::maps::{Begun, Maps};
use super::question::Question;
use super::tabs::Tabs;
use crate::commands::shared::{Chosen, Shown, Subject};
use crate::error::CommandError;
use crate::input::cone_file;
use crate::limits;
use crate::page::PAGE;
use crate::render::Checker;
use cones::{Analysis, Options, SeamOptions};
use geom::Watch;
use geom::distortion::DistortionError;
use geom::io::{GlbTexture, ObjContent, WriteError, write_glb, write_obj};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

const HTML: &str = "text/html; charset=utf-8";
const JSON: &str = "application/json";
const BYTES: &str = "application/octet-stream";

/// One surface on show. Everything but maps is found once, and few maps are kept, so that memory does not grow.
#[derive(Debug)]
pub(super) struct Session<'a> {
    subject: Subject<'a>,
    surface: Vec<u8>,
    tabs: Tabs,
    /// Threads for what must be there at once, and for maps: a map never holds up a preview, nor the browser that draws.
    quick: ThreadPool,
    thorough: ThreadPool,
    maps: Maps,
}

/// An answer, or the refusal in its place.
type Answer = Result<Response, Response>;

impl<'a> Session<'a> {
    /// # Errors
    /// If threads cannot be had.
    pub(super) fn new(subject: Subject<'a>, chosen: &Chosen, threads: usize) -> Result<Self, CommandError> {
        let built = |builder: ThreadPoolBuilder| {
            builder.build().map_err(|error| CommandError::Threads(std::io::Error::other(error)))
        };
        let surface = subject.surface().container(subject.meta(chosen)).bytes("usable", &subject.usable()).finish();
        let quick = built(ThreadPoolBuilder::new().num_threads(1))?;
        let thorough = built(ThreadPoolBuilder::new().num_threads(threads).start_handler(|_| limits::give_way()))?;
        Ok(Self { subject, surface, tabs: Tabs::default(), quick, thorough, maps: Maps::default() })
    }

    /// Says that the map that the page asks for first is [made](Self::make) from now on.
    pub(super) fn begin(&self, chosen: &Chosen) -> Option<Begun> {
        let question = Question::of(chosen.n, self.subject.options.placement, self.subject.options.rule);
        let options = question.options(&self.subject.options, self.subject.most()).ok()?;
        Some(self.maps.begin(options))
    }

    /// Makes what was begun. Where it cannot be had nothing is said: the page will ask for it, and be told.
    pub(super) fn make(&self, begun: Begun) {
        let observed = begun.clone();
        let analysis = self.subject.analysis.with_observer(move |_: cones::Progress| observed.goes_on());
        let make = || self.thorough.install(|| self.subject.map(&analysis, begun.options()));
        // Whoever waits for it is not to wait for ever, should this bring out a fault.
        let shown = catch_unwind(AssertUnwindSafe(make)).ok().and_then(Result::ok);
        self.maps.end(begun, shown.map(Arc::new));
    }

    /// Answers what is asked at a path below the page's.
    pub(super) fn answer(&self, path: &str, request: &Request) -> Response {
        let needed = match path {
            "" | "surface" => "GET",
            "foreseen" | "cones" | "map" | "measured" | "save/obj" | "save/glb" | "save/cones" | "stop" | "leave" => {
                "POST"
            }
            _ => return Response::refusal(404, "there is nothing here"),
        };
        if request.method != needed {
            return Response::refusal(405, &format!("this is asked for with {needed}"));
        }
        let answered = match path {
            "" => Ok(Response { ahead: Some("surface"), ..Response::new(HTML, PAGE.as_bytes().to_vec()) }),
            "surface" => Ok(Response::new(BYTES, self.surface.clone())),
            _ => Question::parse(&request.body).map_err(unclear).and_then(|question| match path {
                "foreseen" => self.foreseen(&question),
                "cones" => self.cones(&question),
                "map" => self.map(&question),
                "measured" => self.measured(&question),
                "stop" => Ok(self.stop(&question, question.serial)),
                "leave" => Ok(self.stop(&question, u64::MAX)),
                _ => self.save(path, &question),
            }),
        };
        answered.unwrap_or_else(|refusal| refusal)
    }

    /// The cones of a method for every number of them, with what is predicted. They are asked for once, so that the page has them
    /// at hand when the slider moves.
    fn foreseen(&self, question: &Question) -> Answer {
        let (placement, rule) =
            (question.options(&self.subject.options, self.subject.most()).map_err(unclear)?.placement, question.rule());
        let foreseen = self.quick.install(|| self.subject.foreseen(placement, rule));
        Ok(to_json(&json!(foreseen.map_err(|error| cannot(&error))?)))
    }

    /// Cones with their curvatures, what is predicted for them, and the seams that their map begins with.
    fn cones(&self, question: &Question) -> Answer {
        let options = self.options(question)?;
        let analysis = self.listening(question);
        let found = self.quick.install(|| {
            let cones = analysis.choose(&options)?;
            // The shortest; those of the map are straight, too.
            let seams = analysis.seams(&cones, &SeamOptions { weight: 0.0, ..options.seams.clone() })?;
            Ok((cones, seams))
        });
        let (cones, seams) = found.map_err(|error: cones::Error| cannot(&error))?;
        Ok(to_json(&json!({ "found": cones, "seams": seams })))
    }

    fn map(&self, question: &Question) -> Answer {
        let options = self.options(question)?;
        let shown = self.shown(question, &options)?;
        let meta = self.subject.map_meta(&shown, &options);
        Ok(Response::new(BYTES, self.subject.drawn(&shown).container(meta).finish()))
    }

    /// What the map that is asked for is like: its map is there before that.
    fn measured(&self, question: &Question) -> Answer {
        let options = self.options(question)?;
        let shown = self.shown(question, &options)?;
        let turn = self.tabs.turn(&question.tab, question.serial);
        let goes_on = |_| turn.goes_on();
        let watch = Watch::new(&goes_on);
        let found = self.thorough.install(|| {
            let quality = self.subject.measure(&shown.uv, &shown.atlas.cones, watch)?;
            Ok((quality, self.subject.predicted(&options, &shown.atlas)))
        });
        let (quality, predicted) = found.map_err(|error| refused(&error))?;
        let mut meta = Subject::measured_meta(&quality, &shown.atlas);
        meta["predicted"] = json!(predicted);
        let container = self.subject.stretches(&quality).container(meta);
        Ok(Response::new(BYTES, container.finish()))
    }

    /// A file of the map that is asked for.
    fn save(&self, path: &str, question: &Question) -> Answer {
        let options = self.options(question)?;
        let shown = self.shown(question, &options)?;
        // Not on the pool of all, whose only thread may be the one that waits for connections.
        let written = self.thorough.install(|| match path {
            "save/cones" => Ok(cone_file::text(shown.atlas.recipe()).into_bytes()),
            "save/glb" => self.glb(&shown),
            _ => self.obj(&shown),
        });
        let written = written.map_err(|error| Response::refusal(422, &error.to_string()))?;
        Ok(Response::new(BYTES, written))
    }

    fn obj(&self, shown: &Shown) -> Result<Vec<u8>, WriteError> {
        let mut bytes = Vec::new();
        let content = ObjContent { uv: Some(&shown.uv), ..ObjContent::default() };
        write_obj(self.subject.model, &content, &mut bytes)?;
        Ok(bytes)
    }

    fn glb(&self, shown: &Shown) -> Result<Vec<u8>, WriteError> {
        let mut bytes = Vec::new();
        let texture = Checker::texture().png()?;
        let triangles = self.subject.model.triangles();
        write_glb(self.subject.model, Some(&shown.uv), &triangles, Some(GlbTexture::Checker(&texture)), &mut bytes)?;
        Ok(bytes)
    }

    /// The tab wants nothing any more of what it asked for before its question of that number.
    fn stop(&self, question: &Question, serial: u64) -> Response {
        self.tabs.turn(&question.tab, serial);
        to_json(&Value::Null)
    }

    /// The map that is asked for: one that is known, or one that is then.
    fn shown(&self, question: &Question, options: &Options) -> Result<Arc<Shown>, Response> {
        let turn = self.tabs.turn(&question.tab, question.serial);
        if let Some(shown) = self.maps.find(options, || turn.goes_on()) {
            return Ok(shown);
        }
        let analysis = self.listening(question);
        let shown = self.thorough.install(|| self.subject.map(&analysis, options));
        let shown = Arc::new(shown.map_err(|error| refused(&error))?);
        self.maps.keep(options.clone(), Arc::clone(&shown));
        Ok(shown)
    }

    /// The analysis, which stops when the tab asks for something newer.
    fn listening(&self, question: &Question) -> Analysis {
        let turn = self.tabs.turn(&question.tab, question.serial);
        self.subject.analysis.with_observer(move |_: cones::Progress| turn.goes_on())
    }

    fn options(&self, question: &Question) -> Result<Options, Response> {
        question.options(&self.subject.options, self.subject.most()).map_err(unclear)
    }
}

fn to_json(value: &Value) -> Response {
    Response::new(JSON, value.to_string().into_bytes())
}

fn unclear(why: String) -> Response {
    Response::refusal(400, &why)
}

/// 409 where a newer question has taken its place, 422 where there is no answer.
fn cannot(error: &cones::Error) -> Response {
    let status = if matches!(error, cones::Error::Interrupted) { 409 } else { 422 };
    Response::refusal(status, &error.to_string())
}

/// The same for a map.
fn refused(error: &CommandError) -> Response {
    match error {
        CommandError::Unwrap { error, .. } => cannot(error),
        CommandError::Measure { error: error @ DistortionError::Interrupted(_), .. } => {
            Response::refusal(409, &error.to_string())
        }
        error => Response::refusal(422, &error.to_string()),
    }
}
