//! Requests and replies.

/// First bytes of either side.
pub(super) const MAGIC: &[u8; 4] = b"PFMU";

/// Version of everything in this folder; both sides are the same program, unless it was replaced while it was running.
pub(super) const VERSION: u32 = 2;

/// First byte of a frame from the child: the answer to a frame of requests.
pub(super) const REPLY: u8 = 1;

/// First byte of a frame from the child: a message of the FMU.
pub(super) const MESSAGE: u8 = 2;

/// First byte of a frame from the child: a request of the frame is done and the next one begins.
pub(super) const PROGRESS: u8 = 3;

/// Outcome of a frame of requests, the byte after [`REPLY`].
pub(super) mod outcome {
    /// Results follow.
    pub const DONE: u8 = 0;
    /// The text of an error follows.
    pub const FAILED: u8 = 1;
    /// The text of an error follows: the FMU cannot be used at all.
    pub const UNFIT: u8 = 2;
    /// The text of an error follows: a call returned a bad status.
    pub const REFUSED: u8 = 3;
}

macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $value:literal,)*) => {
        /// Requests: arguments → results.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub(super) enum Code { $($(#[$doc])* $name = $value,)* }

        impl Code {
            pub(super) fn from_byte(byte: u8) -> Option<Self> {
                match byte {
                    $($value => Some(Self::$name),)*
                    _ => None,
                }
            }
        }
    };
}

codes! {
    /// name, u8 logging → nothing; the first request, once.
    Instantiate = 1,
    /// f64 start, u8 has stop, f64 stop, u8 has tolerance, f64 tolerance → nothing
    SetupExperiment = 2,
    /// → nothing
    EnterInitializationMode = 3,
    /// → nothing
    ExitInitializationMode = 4,
    /// → nothing
    Terminate = 5,
    /// → nothing
    Reset = 6,
    /// [u32] references, [f64] values → nothing
    SetReal = 7,
    /// [u32] references, [i32] values → nothing
    SetInteger = 8,
    /// [u32] references, [i32] values, 0 or 1 → nothing
    SetBoolean = 9,
    /// [u32] references, as many texts → nothing
    SetString = 10,
    /// [u32] references → [f64]
    GetReal = 11,
    /// [u32] references → [i32]
    GetInteger = 12,
    /// [u32] references → [i32], 0 or 1
    GetBoolean = 13,
    /// [u32] references → u32 number, texts
    GetString = 14,
    /// [u32] references, [i32] orders, [f64] values → nothing
    SetRealInputDerivatives = 15,
    /// [u32] references, [i32] orders → [f64]
    GetRealOutputDerivatives = 16,
    /// [u32] unknowns, [u32] knowns, [f64] seed → [f64]
    DirectionalDerivative = 17,
    /// f64 time, f64 step → u8 1 done, 0 discarded (the frame ends there)
    DoStep = 18,
    /// → u8 known, f64 time
    LastSuccessfulTime = 19,
    /// → u8
    WantsToTerminate = 20,
    /// → u32 number of the state
    SaveState = 21,
    /// u32 → nothing
    SaveStateAgain = 22,
    /// u32 → nothing
    RestoreState = 23,
    /// u32 → nothing
    FreeState = 24,
    /// u32 → bytes
    SerializeState = 25,
    /// bytes → u32
    DeserializeState = 26,
    /// u8 on, u32 number, categories → nothing
    SetDebugLogging = 27,
}
