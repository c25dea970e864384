//! The errors that end a verb early, and their exit codes.

use crate::recording::{Problem, ROLES, RecordingError, UNITS};
use std::error::Error;
use std::fmt;
use std::io::{self, IsTerminal, Write};

/// Reason why a verb could not do its work.
///
/// Bad input leaves with exit code 2, any other failure with 1; output into a pipe that nobody
/// reads any more is no failure and leaves quietly with 0.
#[derive(Debug)]
pub enum CliError {
    /// The user's arguments or files are wrong: exit code 2.
    Input(Message),
    /// The work failed for another reason: exit code 1.
    Failure(Message),
    /// Standard output was closed by its reader: exit code 0, nothing printed.
    BrokenPipe,
}

/// One readable message: the error, its causes, and advice.
#[derive(Debug)]
pub struct Message {
    text: String,
    help: Option<String>,
    source: Option<Box<dyn Error + Send + Sync>>,
}

impl CliError {
    /// Bad input, described by the error of the module that refused it (its sources are printed too).
    pub fn input(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Input(Message::new(error.into()))
    }

    /// A failure that the input did not cause.
    pub fn failure(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Failure(Message::new(error.into()))
    }

    /// The same error with a sentence on what the user can do about it.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        if let Self::Input(message) | Self::Failure(message) = &mut self {
            message.help = Some(help.into());
        }
        self
    }

    /// The exit codes of all verbs, and when a verb ends with them.
    pub const EXIT_CODES: [(u8, &str); 3] = [
        (0, "it is done, or the reader of its output went away"),
        (
            1,
            "it failed for a reason that is not the input's: a disk, a network, a thread",
        ),
        (
            2,
            "bad input: an argument or a file is refused, or a recording cannot contradict the model (`not_excited`)",
        ),
    ];

    /// 2 for bad input, 1 for another failure, 0 for a closed pipe.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Failure(_) => 1,
            Self::BrokenPipe => 0,
        }
    }

    /// The error as printed if stderr is no terminal: the error, its causes, the advice.
    pub fn told(&self) -> String {
        match self {
            Self::Input(message) | Self::Failure(message) => message.plain(),
            Self::BrokenPipe => String::new(),
        }
    }

    /// Prints the error on stderr, drawn on a terminal and plain elsewhere, and returns the exit code.
    pub fn report(self) -> u8 {
        let code = self.exit_code();
        let message = match self {
            Self::Input(message) | Self::Failure(message) => message,
            Self::BrokenPipe => return code,
        };
        let mut stderr = io::stderr();
        // If stderr is closed as well, the message cannot reach anybody.
        let _ = if stderr.is_terminal() {
            writeln!(stderr, "{:?}", miette::Report::new(message))
        } else {
            write!(stderr, "{}", message.plain())
        };
        code
    }
}

/// A refused recording is bad input; for a recording that could not be written use `map_err(CliError::failure)`
/// instead.
impl From<RecordingError> for CliError {
    fn from(error: RecordingError) -> Self {
        let help = match &error.problem {
            Problem::NoManifest => Some(MANIFEST_HELP.to_owned()),
            Problem::Uncertain { .. } => Some(format!(
                "quell inspect {} writes a recording.toml with what it guesses; correct it there",
                error.place.file.display()
            )),
            Problem::NoJoints => Some(TOPIC_HELP.to_owned()),
            Problem::UnknownRole { .. } => Some(format!(
                "roles: {}",
                names(ROLES.iter().map(|entry| entry.name))
            )),
            Problem::UnknownUnit { .. } => Some(format!(
                "units: {}",
                names(UNITS.iter().map(|unit| unit.names[0]))
            )),
            _ => None,
        };
        let error = Self::input(error);
        match help {
            Some(help) => error.with_help(help),
            None => error,
        }
    }
}

const MANIFEST_HELP: &str = "\
quell inspect FILE.csv proposes one; it is a text file beside the CSV file, recording.toml, such as
    name = \"arm 7\"
    [[channel]]
    role = \"motor_position\"
    file = \"encoder.csv.gz\"
    time = \"time_s\"
    column = \"joint_1_rad\"
    unit = \"rad\"";

const TOPIC_HELP: &str = "\
`quell inspect` lists its topics; name them in a recording.toml beside it, such as
    name = \"arm 7\"
    [[channel]]
    role = \"motor_position\"
    file = \"run.mcap\"
    topic = \"/joint_states\"
    field = \"position[shoulder]\"
    unit = \"rad\"";

fn names(names: impl Iterator<Item = &'static str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

impl From<io::Error> for CliError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::BrokenPipe,
            _ => Self::failure(error),
        }
    }
}

impl Message {
    fn new(error: Box<dyn Error + Send + Sync>) -> Self {
        Self {
            text: error.to_string(),
            help: None,
            source: Some(error),
        }
    }

    /// `error: ...`, one `caused by: ...` line for each source, and `help: ...`.
    fn plain(&self) -> String {
        let mut text = format!("error: {}\n", self.text);
        let mut source = Error::source(self);
        while let Some(error) = source {
            // Some errors repeat the text of their source.
            let cause = error.to_string();
            if !text.contains(&cause) {
                text.push_str(&format!("  caused by: {cause}\n"));
            }
            source = error.source();
        }
        if let Some(help) = &self.help {
            text.push_str(&format!("  help: {help}\n"));
        }
        text
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Error for Message {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        // The text is the error's own, so the chain goes on with the error's source.
        self.source.as_ref().and_then(|error| error.source())
    }
}

impl miette::Diagnostic for Message {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help
            .as_ref()
            .map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }
}
