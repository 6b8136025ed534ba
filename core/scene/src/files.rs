//! Files that a scene takes tables and parts from while it is read.

use std::cell::RefCell;

use crate::error::Place;

/// Text of a file, or why there is none.
type Open<'a> = Box<dyn Fn(&str) -> Result<String, String> + 'a>;

/// Files beside a scene, and what was read of them, which messages name.
pub struct Files<'a> {
    open: Open<'a>,
    read: RefCell<Vec<Read>>,
}

struct Read {
    path: String,
    columns: Vec<String>,
}

impl<'a> Files<'a> {
    /// Files of which `open` gives the text, by their paths as the scene has them, or says why it cannot.
    pub fn new(open: impl Fn(&str) -> Result<String, String> + 'a) -> Self {
        Self {
            open: Box::new(open),
            read: RefCell::default(),
        }
    }

    /// No files: a scene must be complete in itself.
    #[must_use]
    pub fn none() -> Self {
        Self::new(|_| {
            Err("must be left out: a scene without files beside it is needed, such as scene.toml of a run".into())
        })
    }

    /// Text of a file and the number by which places in it are known.
    pub(crate) fn open(&self, path: &str) -> Result<(String, u16), String> {
        let text = (self.open)(path)?;
        let mut read = self.read.borrow_mut();
        let number = u16::try_from(read.len()).map_err(|_| "is one file too many".to_owned())?;
        read.push(Read {
            path: path.to_owned(),
            columns: Vec::new(),
        });
        Ok((text, number))
    }

    /// Names the columns of a file.
    pub(crate) fn name_columns(&self, file: u16, columns: Vec<String>) {
        self.read.borrow_mut()[usize::from(file)].columns = columns;
    }

    /// A line of a file, and in a table a column.
    pub(crate) fn place(&self, file: u16, line: usize, column: Option<u16>) -> Place {
        let read = &self.read.borrow()[usize::from(file)];
        let column = column.and_then(|column| read.columns.get(usize::from(column)).cloned());
        match column {
            Some(column) => Place::Cell(read.path.clone(), line, column),
            None => Place::Line(read.path.clone(), line),
        }
    }
}
