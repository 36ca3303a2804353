//! What can be wrong with a scene: one message, the place in the text and the way out.

use super::document::{Place, Sources};
use super::suggest;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt;
use std::path::PathBuf;

/// A scene that cannot be used: why, where, and what to do about it.
#[derive(Debug, Clone)]
pub struct SceneError(Box<Inner>);

#[derive(Debug, Clone)]
struct Inner {
    kind: ErrorKind,
    place: Option<Place>,
    text: Option<NamedSource<String>>,
    sources: Sources,
}

/// The classes of mistakes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The scene file cannot be read.
    #[error("cannot read the scene {}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The text is not TOML.
    #[error("this is not valid TOML: {message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A number that is no finite number of 64 bits.
    #[error("this number cannot be used: it is infinite, undefined or too large")]
    NotFinite,
    /// A `--set` argument without a key or a value.
    #[error("a --set argument has the form key.path=value")]
    OverrideForm,
    /// A `--set` path that points past the end of an array.
    #[error("`{key}` is no index into an array of {length}")]
    OverrideIndex {
        /// The step of the path.
        key: String,
        /// Length of the array.
        length: usize,
    },
    /// A `--set` path through a value that is no table.
    #[error("`{key}` cannot be set here: the path leads through {found}")]
    OverridePath {
        /// The step of the path.
        key: String,
        /// What is there.
        found: String,
    },
    /// A key that means nothing here.
    #[error("unknown key `{key}` in {table}")]
    UnknownKey {
        /// The key.
        key: String,
        /// The table in words.
        table: String,
        /// The keys that would be valid.
        valid: Vec<String>,
    },
    /// A word that is none of the choices.
    #[error("`{key}` cannot be \"{found}\"")]
    UnknownChoice {
        /// The key with its path.
        key: String,
        /// The word found.
        found: String,
        /// The words that would be valid.
        valid: Vec<String>,
    },
    /// A value of another type than the key asks for.
    #[error("`{key}` must be {expected}, found {found}")]
    WrongType {
        /// The key with its path.
        key: String,
        /// What it should be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// A key without which the scene means nothing.
    #[error("{table} lacks the key `{key}`")]
    MissingKey {
        /// The key.
        key: String,
        /// The table in words.
        table: String,
    },
    /// A vector of another length than the scene's dimension.
    #[error("`{key}` has {found} components, but the scene has dimension = {dimension}")]
    Components {
        /// The key with its path.
        key: String,
        /// Components found.
        found: usize,
        /// Components needed.
        dimension: usize,
    },
    /// A value out of its range.
    #[error("`{key}` must be {range}, found {found}")]
    OutOfRange {
        /// The key with its path.
        key: String,
        /// Allowed values in words.
        range: &'static str,
        /// The value.
        found: String,
        /// Why, and what to do.
        help: String,
    },
    /// A formula that cannot be read or evaluated.
    #[error("the formula \"{formula}\" cannot be used: {reason}")]
    Formula {
        /// The formula.
        formula: String,
        /// What is wrong.
        reason: String,
        /// What to do.
        help: String,
    },
    /// Any other contradiction.
    #[error("{what}")]
    Invalid {
        /// What is wrong.
        what: String,
        /// What to do.
        help: String,
    },
    /// A mesh file that is missing, unreadable or no closed surface.
    #[error("the mesh {} cannot be used: {reason}", path.display())]
    Mesh {
        /// The file, as resolved.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
        /// What to do.
        help: String,
    },
    /// Fluid inside a solid, and none anywhere else.
    #[error(
        "region {region} of fluid `{fluid}` overlaps solid `{solid}`: {count} particles would be \
         inside it, the first at {example:?}"
    )]
    Overlap {
        /// Name of the fluid.
        fluid: String,
        /// Index of the region.
        region: usize,
        /// Name of the solid.
        solid: String,
        /// Number of particles of the region inside the solid.
        count: usize,
        /// Where one of them is, m.
        example: Vec<f64>,
    },
    /// No fluid particle.
    #[error("there is nothing to simulate: {why}")]
    Nothing {
        /// Why.
        why: String,
        /// What to do.
        help: String,
    },
    /// More ranks than there are particles to own.
    #[error("{ranks} ranks are more than the {particles} particles of the scene")]
    TooManyRanks {
        /// Ranks asked for.
        ranks: usize,
        /// Particles of the scene.
        particles: usize,
    },
}

impl ErrorKind {
    /// What to do about it.
    pub fn help(&self) -> Option<String> {
        let help = match self {
            Self::Unreadable { .. } => {
                "give the path of a scene file, for example scenes/dam-break-2d.toml".into()
            }
            Self::Syntax { .. } => {
                "texts need quotes, elements of arrays commas between them; see https://toml.io"
                    .into()
            }
            Self::NotFinite => "write a number such as 0.02 or 1e-3".into(),
            Self::OverrideForm => "for example: --set numerics.spacing=0.01".into(),
            Self::OverrideIndex { length: 0, .. } => "the array is empty".into(),
            Self::OverrideIndex { length, .. } => {
                format!("arrays count from 0: use 0 to {}", length - 1)
            }
            Self::OverridePath { .. } => "set the whole value instead".into(),
            Self::UnknownKey { key, valid, .. } => suggest::help(key, valid, "keys here"),
            Self::UnknownChoice { found, valid, .. } => suggest::help(found, valid, "choices"),
            Self::WrongType { found, expected, .. } => {
                let text = found.starts_with("the string");
                match expected.as_str() {
                    number if number.contains("number") && text => "write it without quotes",
                    number if number.contains("whole") => "for example 2",
                    number if number.contains("a number") => "for example 0.5 or 1e-3",
                    "an array" => "put it in brackets, with commas between the elements: [1, 2]",
                    "a table" => "put it in braces: { key = value }",
                    _ => "put a text in quotes",
                }
                .into()
            }
            Self::MissingKey { key, table } => format!("add `{key}` to {table}"),
            Self::Components { dimension, .. } => {
                format!("give {dimension} numbers, or change `dimension`")
            }
            Self::OutOfRange { help, .. }
            | Self::Formula { help, .. }
            | Self::Invalid { help, .. }
            | Self::Mesh { help, .. }
            | Self::Nothing { help, .. } => help.clone(),
            Self::Overlap { .. } => {
                "no particle is left: move the region out of the solid, or check \
                                     `fluid_side` of the solid"
                    .into()
            }
            Self::TooManyRanks { particles, .. } => {
                format!("use at most {particles} ranks, or a smaller numerics.spacing")
            }
        };
        Some(help).filter(|help| !help.is_empty())
    }

    /// A word or two beside the place in the text.
    fn label(&self) -> &'static str {
        match self {
            Self::UnknownKey { .. } => "not a key of this table",
            Self::UnknownChoice { .. } => "not one of the choices",
            Self::WrongType { .. } => "wrong type",
            Self::MissingKey { .. } => "in this table",
            Self::OutOfRange { .. } | Self::NotFinite => "out of range",
            Self::Overlap { .. } => "this region",
            _ => "here",
        }
    }
}

impl SceneError {
    /// An error of `kind` at `place` in one of the `sources`; without a place it concerns no text.
    pub fn new(kind: ErrorKind, place: Option<Place>, sources: Sources) -> Self {
        let source = place.and_then(|place| sources.get(place));
        let text = source.map(|source| NamedSource::new(&source.name, source.text.clone()));
        Self(Box::new(Inner { kind, place, text, sources }))
    }

    /// What is wrong.
    pub fn kind(&self) -> &ErrorKind {
        &self.0.kind
    }

    /// Name of the text in which the mistake is: the scene file or `--set`.
    pub fn source_name(&self) -> Option<&str> {
        self.0.text.as_ref().map(NamedSource::name)
    }

    /// Line and column of the mistake, from 1.
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        self.0.sources.line_and_column(self.0.place?)
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.kind.fmt(f)
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.kind.help().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.0.text.as_ref().map(|text| text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (place, text) = (self.0.place?, self.0.text.as_ref()?);
        // A place at the very end of a text would point past its last line.
        let length = text.inner().len();
        let start = place.start.min(length.saturating_sub(1));
        let end = place.end.clamp(start, length);
        let label = self.0.kind.label().to_string();
        Some(Box::new(std::iter::once(LabeledSpan::new(Some(label), start, end - start))))
    }
}
