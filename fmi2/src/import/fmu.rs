//! An unpacked FMU.

use super::binary::Binary;
use super::guard::Note;
use super::instance::Instance;
use super::log::Listener;
use crate::Error;
use crate::archive::{self, ArchiveError, Limits};
use crate::model_description::ModelDescription;
use crate::scratch::Scratch;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Options for opening an FMU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Limits of the archive.
    pub limits: Limits,
    /// Longest wall time of a call, after which the process ends, see [`guard`](super::guard). `None` for no limit.
    pub time_limit: Option<Duration>,
}

/// State shared by the instances of an FMU; dropped in the order of the members.
pub(super) struct Shared {
    pub path: PathBuf,
    pub description: ModelDescription,
    /// Library, loaded with the first instance.
    binary: Mutex<Option<Arc<Binary>>>,
    pub time_limit: Option<Duration>,
    folder: Folder,
}

/// Folder of an unpacked archive.
enum Folder {
    /// Own folder, removed at the end.
    Own(Scratch),
    /// Folder of the caller, who removes it.
    Lent(PathBuf),
}

impl Shared {
    pub(super) fn folder(&self) -> &Path {
        match &self.folder {
            Folder::Own(folder) => folder.path(),
            Folder::Lent(folder) => folder,
        }
    }
}

/// An FMU: its description and its folder, which lives as long as the FMU and its last instance.
#[derive(Clone)]
pub struct Fmu {
    shared: Arc<Shared>,
}

impl fmt::Debug for Fmu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Fmu")
            .field("path", &self.shared.path)
            .finish_non_exhaustive()
    }
}

impl Fmu {
    /// Unpacks an archive into a private folder and reads its model description. The binary is not touched.
    ///
    /// # Errors
    ///
    /// An archive or a description that is refused.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::open_with(path, &Options::default())
    }

    /// [`open`](Self::open) with other limits.
    ///
    /// # Errors
    ///
    /// An archive or a description that is refused.
    pub fn open_with(path: impl AsRef<Path>, options: &Options) -> Result<Self, Error> {
        let path = path.as_ref().to_owned();
        let refused = |problem| Error::Archive {
            path: path.clone(),
            problem,
        };
        let folder = archive::extract(&path, archive::DESCRIPTION_FILE, &options.limits).map_err(refused)?;
        let description = described(&path, folder.path())?;
        let resources = folder.path().join("resources");
        std::fs::create_dir_all(&resources).map_err(|problem| {
            refused(ArchiveError::Unwritable {
                target: resources,
                problem,
            })
        })?;
        let folder = Folder::Own(folder);
        Ok(Self::of(path, description, folder, options.time_limit))
    }

    /// An FMU that the caller has unpacked into `folder` and removes after the FMU and its last instance are gone;
    /// `path` is the archive, for messages.
    ///
    /// # Errors
    ///
    /// A description that is refused.
    pub fn unpacked(
        path: impl AsRef<Path>,
        folder: impl AsRef<Path>,
        time_limit: Option<Duration>,
    ) -> Result<Self, Error> {
        let (path, folder) = (path.as_ref().to_owned(), folder.as_ref().to_owned());
        let description = described(&path, &folder)?;
        Ok(Self::of(path, description, Folder::Lent(folder), time_limit))
    }

    fn of(path: PathBuf, description: ModelDescription, folder: Folder, time_limit: Option<Duration>) -> Self {
        let shared = Shared {
            path,
            description,
            binary: Mutex::new(None),
            time_limit,
            folder,
        };
        Self {
            shared: Arc::new(shared),
        }
    }

    /// The archive.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.shared.path
    }

    /// Folder of the unpacked archive.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.shared.folder()
    }

    /// The model description.
    #[must_use]
    pub fn description(&self) -> &ModelDescription {
        &self.shared.description
    }

    /// Makes an instance; the binary is loaded with the first one. `name` must differ from that of other instances.
    ///
    /// # Errors
    ///
    /// No binary for this platform, a binary that cannot be loaded, or an instance that cannot be made.
    pub fn instantiate(&self, name: &str, visible: bool, logging: bool) -> Result<Instance, Error> {
        self.instantiate_heard(name, visible, logging, None)
    }

    /// [`instantiate`](Self::instantiate) with a listener that receives each message of the FMU at once.
    ///
    /// # Errors
    ///
    /// As [`instantiate`](Self::instantiate).
    pub fn instantiate_heard(
        &self,
        name: &str,
        visible: bool,
        logging: bool,
        listener: Option<Listener>,
    ) -> Result<Instance, Error> {
        let label = self.label(name);
        let note = Note::taken(&label, self.shared.time_limit);
        let binary = match note.during("loading its binary", || self.binary()) {
            Ok(binary) => binary,
            Err(error) => {
                note.release();
                return Err(error);
            }
        };
        Instance::new(
            Arc::clone(&self.shared),
            binary,
            note,
            (name, visible, logging),
            listener,
        )
    }

    /// Name of an instance in reports.
    fn label(&self, name: &str) -> String {
        let file = self.shared.path.file_name().unwrap_or_default().to_string_lossy();
        format!("{name} ({}, {file})", self.shared.description.model_name)
    }

    fn binary(&self) -> Result<Arc<Binary>, Error> {
        let shared = &self.shared;
        let mut binary = shared.binary.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(binary) = &*binary {
            return Ok(Arc::clone(binary));
        }
        let identifier = &shared.description.co_simulation.model_identifier;
        let folder = std::path::absolute(shared.folder()).unwrap_or_else(|_| shared.folder().to_owned());
        let loaded = Arc::new(Binary::loaded(&shared.path, &folder, identifier)?);
        *binary = Some(Arc::clone(&loaded));
        Ok(loaded)
    }
}

/// Reads the model description of the archive at `path`, which is unpacked into `folder`.
fn described(path: &Path, folder: &Path) -> Result<ModelDescription, Error> {
    let bytes = std::fs::read(folder.join(archive::DESCRIPTION_FILE)).map_err(|problem| Error::Archive {
        path: path.to_owned(),
        problem: ArchiveError::Unreadable { problem },
    })?;
    ModelDescription::from_xml(&bytes).map_err(|problem| Error::Description {
        path: path.to_owned(),
        problem,
    })
}
