//! The table as one Parquet file, written in groups of rows as they come.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};

use crate::plan::Plan;
use crate::table::{Cell, CellKind, SERIES_COLUMNS, columns};

/// Rows of a group.
const ROWS: usize = 16_384;

/// Samples of a group, so that its memory is bounded with series too.
const SAMPLES: usize = 2_000_000;

/// Filtered force of a row: samples, time of the first one and between two, s.
pub type RowSeries = Option<(Vec<f64>, f64, f64)>;

/// A Parquet file of rows.
pub struct ParquetTable {
    writer: SerializedFileWriter<File>,
    kinds: Vec<CellKind>,
    series: bool,
    rows: Vec<(Vec<Cell>, RowSeries)>,
    samples: usize,
}

/// Levels of the format for entries that may be missing: 1 where there is one.
const PRESENT: i16 = 1;

/// Definition levels of a list: no list, an empty one, one with an entry.
const NO_LIST: i16 = 0;
const EMPTY_LIST: i16 = 1;
const ENTRY: i16 = 2;

fn optional(name: &str, physical: Physical, logical: Option<LogicalType>) -> Result<TypePtr, ParquetError> {
    let column = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
    column.with_logical_type(logical).build().map(Arc::new)
}

/// `name`: optional list of numbers, in the three levels that the format prescribes.
fn list(name: &str) -> Result<TypePtr, ParquetError> {
    let element = Type::primitive_type_builder("element", Physical::DOUBLE).with_repetition(Repetition::REQUIRED);
    let entries = Type::group_type_builder("list").with_repetition(Repetition::REPEATED);
    let entries = entries.with_fields(vec![Arc::new(element.build()?)]).build()?;
    let list = Type::group_type_builder(name).with_repetition(Repetition::OPTIONAL);
    let list = list
        .with_logical_type(Some(LogicalType::List))
        .with_converted_type(ConvertedType::LIST);
    list.with_fields(vec![Arc::new(entries)]).build().map(Arc::new)
}

impl ParquetTable {
    /// Begins the file with the columns of a plan; those of the filtered force with `series`.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn new(plan: &Plan, series: bool, path: &Path) -> Result<Self, ParquetError> {
        let columns = columns(plan);
        let mut fields = Vec::new();
        for (name, kind) in &columns {
            fields.push(match kind {
                CellKind::Count => optional(name, Physical::INT64, None)?,
                CellKind::Number => optional(name, Physical::DOUBLE, None)?,
                CellKind::Text => optional(name, Physical::BYTE_ARRAY, Some(LogicalType::String))?,
            });
        }
        if series {
            let [samples, times @ ..] = SERIES_COLUMNS;
            fields.push(list(samples)?);
            for name in times {
                fields.push(optional(name, Physical::DOUBLE, None)?);
            }
        }
        let schema = Arc::new(Type::group_type_builder("sweep").with_fields(fields).build()?);
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
        let writer = SerializedFileWriter::new(File::create(path)?, schema, Arc::new(properties))?;
        let kinds = columns.into_iter().map(|(_, kind)| kind).collect();
        Ok(Self {
            writer,
            kinds,
            series,
            rows: Vec::new(),
            samples: 0,
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn row(&mut self, row: Vec<Cell>, series: RowSeries) -> Result<(), ParquetError> {
        self.samples += series.as_ref().map_or(0, |(samples, ..)| samples.len());
        self.rows.push((row, series));
        if self.rows.len() >= ROWS || self.samples >= SAMPLES {
            self.group()?;
        }
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn finish(mut self) -> Result<(), ParquetError> {
        self.group()?;
        self.writer.close().map(|_| ())
    }

    /// Writes the rows that wait.
    fn group(&mut self) -> Result<(), ParquetError> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let rows = std::mem::take(&mut self.rows);
        self.samples = 0;
        let mut group = self.writer.next_row_group()?;
        let mut columns: Vec<Entries> = (0..self.kinds.len())
            .map(|index| entries(&rows, self.kinds[index], index))
            .collect();
        if self.series {
            columns.push(lists(&rows));
            let series = || rows.iter().map(|(_, series)| series.as_ref());
            columns.push(numbers(series().map(|series| series.map(|(_, from, _)| *from))));
            columns.push(numbers(series().map(|series| series.map(|(.., step)| *step))));
        }
        for Entries {
            values,
            definitions,
            repetitions,
        } in columns
        {
            let Some(mut column) = group.next_column()? else { break };
            let (definitions, repetitions) = (Some(&*definitions), repetitions.as_deref());
            match (column.untyped(), &values) {
                (ColumnWriter::Int64ColumnWriter(writer), Typed::Counts(values)) => {
                    writer.write_batch(values, definitions, repetitions)?;
                }
                (ColumnWriter::DoubleColumnWriter(writer), Typed::Numbers(values)) => {
                    writer.write_batch(values, definitions, repetitions)?;
                }
                (ColumnWriter::ByteArrayColumnWriter(writer), Typed::Texts(values)) => {
                    writer.write_batch(values, definitions, repetitions)?;
                }
                _ => {
                    return Err(ParquetError::General(
                        "a column does not have the type of its schema".to_owned(),
                    ));
                }
            }
            column.close()?;
        }
        group.close().map(|_| ())
    }
}

/// Values of a column that are there.
enum Typed {
    Counts(Vec<i64>),
    Numbers(Vec<f64>),
    Texts(Vec<ByteArray>),
}

/// Values of a column in a group, and its levels.
struct Entries {
    values: Typed,
    definitions: Vec<i16>,
    repetitions: Option<Vec<i16>>,
}

fn entries(rows: &[(Vec<Cell>, RowSeries)], kind: CellKind, column: usize) -> Entries {
    let cells = || rows.iter().map(|(row, _)| &row[column]);
    let definitions = |there: &mut dyn Iterator<Item = bool>| there.map(|there| i16::from(there) * PRESENT).collect();
    match kind {
        CellKind::Number => numbers(cells().map(|cell| if let Cell::Number(value) = cell { *value } else { None })),
        CellKind::Count => {
            let counts = cells().map(|cell| if let Cell::Count(value) = cell { *value } else { None });
            let counts: Vec<Option<i64>> = counts
                .map(|count| count.and_then(|count| i64::try_from(count).ok()))
                .collect();
            Entries {
                definitions: definitions(&mut counts.iter().map(Option::is_some)),
                values: Typed::Counts(counts.into_iter().flatten().collect()),
                repetitions: None,
            }
        }
        CellKind::Text => {
            let texts: Vec<Option<&str>> = cells()
                .map(|cell| {
                    if let Cell::Text(text) = cell {
                        text.as_deref()
                    } else {
                        None
                    }
                })
                .collect();
            Entries {
                definitions: definitions(&mut texts.iter().map(Option::is_some)),
                values: Typed::Texts(texts.into_iter().flatten().map(ByteArray::from).collect()),
                repetitions: None,
            }
        }
    }
}

fn numbers(values: impl Iterator<Item = Option<f64>>) -> Entries {
    let values: Vec<Option<f64>> = values.collect();
    Entries {
        definitions: values
            .iter()
            .map(|value| i16::from(value.is_some()) * PRESENT)
            .collect(),
        values: Typed::Numbers(values.into_iter().flatten().collect()),
        repetitions: None,
    }
}

fn lists(rows: &[(Vec<Cell>, RowSeries)]) -> Entries {
    let (mut values, mut definitions, mut repetitions) = (Vec::new(), Vec::new(), Vec::new());
    for (_, series) in rows {
        let samples = series.as_ref().map(|(samples, ..)| &**samples);
        // The first entry of a list begins a row, the others repeat it.
        repetitions.push(0);
        match samples {
            None => definitions.push(NO_LIST),
            Some([]) => definitions.push(EMPTY_LIST),
            Some(samples) => {
                definitions.extend(samples.iter().map(|_| ENTRY));
                repetitions.extend(samples.iter().skip(1).map(|_| 1));
                values.extend_from_slice(samples);
            }
        }
    }
    Entries {
        values: Typed::Numbers(values),
        definitions,
        repetitions: Some(repetitions),
    }
}
