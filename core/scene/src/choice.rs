//! Keys whose value is one of a few words.

/// A word of the scene file: the names that are available, and those that are known but not yet available.
pub(crate) trait Choice: Copy + PartialEq + 'static {
    /// Every available word with its meaning, in the order in which messages list them.
    const NAMES: &'static [(&'static str, Self)];
    /// Words that have a meaning in the scene format but that this version cannot do.
    const UNAVAILABLE: &'static [&'static str];
}

/// Declares an enum whose variants are words of the scene file.
macro_rules! choice {
    (
        $(#[$meta:meta])*
        $vis:vis enum $name:ident {
            $($(#[$variant_meta:meta])* $variant:ident = $word:literal),+ $(,)?
        }
        unavailable: [$($unavailable:literal),*]
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $vis enum $name {
            $($(#[$variant_meta])* $variant),+
        }

        impl $name {
            /// All of them, in the order in which messages list them.
            #[allow(dead_code)]
            $vis const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The word that stands for it in the scene file.
            #[must_use]
            $vis const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),+
                }
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        impl crate::choice::Choice for $name {
            const NAMES: &'static [(&'static str, Self)] = &[$(($word, Self::$variant)),+];
            const UNAVAILABLE: &'static [&'static str] = &[$($unavailable),*];
        }
    };
}
pub(crate) use choice;
