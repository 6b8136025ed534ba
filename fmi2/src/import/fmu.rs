//! An unpacked FMU.

use super::binary::Binary;
use super::instance::Instance;
use crate::Error;
use crate::archive::{self, ArchiveError, Limits};
use crate::model_description::ModelDescription;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use tempfile::TempDir;

/// How an FMU is opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// What the archive may hold.
    pub limits: Limits,
    /// Whether the folder of the unpacked FMU is kept at the end.
    pub keep: Keep,
}

/// What happens to the folder of the unpacked FMU at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// It is removed.
    #[default]
    Nothing,
    /// It stays, for somebody to look into.
    Folder,
}

/// What the instances of an FMU share; dropped in the order of the members.
pub(super) struct Shared {
    pub path: PathBuf,
    pub description: ModelDescription,
    /// Loaded with the first instance.
    binary: Mutex<Option<Arc<Binary>>>,
    pub folder: TempDir,
}

/// An FMU: its description and its folder, which lives as long as this and the last instance.
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

    /// [`open`](Self::open) with other limits, or keeping the folder.
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
        let mut folder = archive::extract(&path, archive::DESCRIPTION_FILE, &options.limits).map_err(refused)?;
        let bytes = std::fs::read(folder.path().join(archive::DESCRIPTION_FILE))
            .map_err(|problem| refused(ArchiveError::Unreadable { problem }))?;
        let description = ModelDescription::from_xml(&bytes).map_err(|problem| Error::Description {
            path: path.clone(),
            problem,
        })?;
        let resources = folder.path().join("resources");
        std::fs::create_dir_all(&resources).map_err(|problem| {
            refused(ArchiveError::Unwritable {
                target: resources,
                problem,
            })
        })?;
        folder.disable_cleanup(options.keep == Keep::Folder);
        let shared = Shared {
            path,
            description,
            binary: Mutex::new(None),
            folder,
        };
        Ok(Self {
            shared: Arc::new(shared),
        })
    }

    /// The archive.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.shared.path
    }

    /// The folder it was unpacked into.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.shared.folder.path()
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
        let binary = self.binary()?;
        Instance::new(Arc::clone(&self.shared), binary, name, visible, logging)
    }

    fn binary(&self) -> Result<Arc<Binary>, Error> {
        let shared = &self.shared;
        let mut binary = shared.binary.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(binary) = &*binary {
            return Ok(Arc::clone(binary));
        }
        let identifier = &shared.description.co_simulation.model_identifier;
        let folder = std::path::absolute(shared.folder.path()).unwrap_or_else(|_| shared.folder.path().to_owned());
        let loaded = Arc::new(Binary::loaded(&shared.path, &folder, identifier)?);
        *binary = Some(Arc::clone(&loaded));
        Ok(loaded)
    }
}
