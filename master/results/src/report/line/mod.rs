//! Page of a line at rest.
//!
//! | file | subject |
//! | --- | --- |
//! | `page` | what is drawn and tabled, and the page of it |
//! | `panels` | panels over the track: elevation, contact wire, plan, curvature, droppers, elasticity |
//! | `panel` | one panel: scale, grid, curves, labels |
//! | `polyline` | curves in whole units, without points that say nothing |
//! | `tables` | limits, supports, droppers, wires, spans, model |
//! | `csv` | the same droppers and supports as CSV |
//! | `picture` | elevation and plan as one small SVG |

mod csv;
mod page;
mod panel;
mod panels;
mod picture;
mod polyline;
mod tables;

pub use page::{
    LinePage, PageDropper, PageMass, PageRange, PageSpan, PageSupport, PageTension, PageWire, PageWireKind,
};
