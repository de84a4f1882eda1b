//! What a program found out about a scan beside its points, for sinks that keep it.

/// How good something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum DiagnosticLevel {
    /// As it should be.
    Ok = 0,
    /// To be known by whoever uses the cloud.
    Warn = 1,
    /// The cloud is not what was asked for.
    Error = 2,
}

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// What was looked at.
    pub name: String,
    /// How good it is.
    pub level: DiagnosticLevel,
    /// The finding in a sentence.
    pub message: String,
    /// Names and values behind it, in their order.
    pub values: Vec<(String, String)>,
}
