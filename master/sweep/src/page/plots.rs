//! Plots of the page, as plotly.js takes them.

use results::report::{Library, figure_html};
use serde_json::{Value as Json, json};

use super::{Drawn, FIGURES, Key, Page, in_unit};
use crate::values::Value;

/// Colours of the curves, told apart with colour-blind eyes too.
const COLOURS: [&str; 7] = results::report::plots::COLOURS;

/// Scale from small to large values.
const SCALE: &str = "Viridis";

/// Height of a plot, CSS pixels.
const HEIGHT: u32 = 360;

/// Slant of the names over parallel axes, degrees: long names stand over those of the next axes, not on them.
const SLANT: f64 = 30.0;

/// Width of a letter of these names, CSS pixels.
const LETTER: f64 = 7.0;

/// A plot in a box with this `id`; `name` is read out where plots are not seen.
fn plot((id, name): (&str, &str), height: u32, traces: &[Json], mut layout: Json) -> String {
    if layout["margin"].is_null() {
        layout["margin"] = json!({ "l": 60, "r": 16, "t": 34, "b": 50 });
    }
    layout["font"] = json!({ "family": "system-ui, sans-serif", "size": 13 });
    let config = json!({ "responsive": true, "displaylogo": false, "displayModeBar": false });
    let library = match traces.iter().all(|trace| trace["type"] == "scatter") {
        true => Library::Curves,
        false => Library::Whole,
    };
    let figure = json!({ "data": traces, "layout": layout, "config": config });
    figure_html(&figure.to_string(), (id, name), height, library)
}

/// Plots in two columns, each with its buttons in one box.
fn in_pairs(plots: &[String]) -> String {
    let boxes: String = plots.iter().map(|plot| format!("<div>{plot}</div>\n")).collect();
    format!("<div class=\"pair\">{boxes}</div>\n")
}

/// Ends of a scale for values that are all zero, which would have negative ones; nothing for others.
fn scale_of_zeros(values: &[Option<f64>]) -> Option<[f64; 2]> {
    values.iter().flatten().all(|value| *value == 0.0).then_some([0.0, 1.0])
}

/// An upright axis, its title clear of its numbers.
fn upright(title: &str) -> Json {
    json!({ "title": { "text": title, "standoff": 8 }, "automargin": true })
}

/// Upright axis of a figure; one of zeros begins at zero.
fn axis(title: &str, values: &[Option<f64>]) -> Json {
    let mut axis = upright(title);
    if let Some(ends) = scale_of_zeros(values) {
        axis["range"] = json!(ends);
    }
    axis
}

/// A key's value on an axis.
fn on_axis(value: &Value) -> Json {
    value.number().map_or_else(|| Json::from(value.shown()), Json::from)
}

/// Sections of the varied keys.
pub(super) fn sections(page: &Page) -> Vec<(String, String)> {
    let pantographs = page.drawn.iter().map(|row| row.pantograph).max().unwrap_or(0);
    if page.drawn.iter().all(|row| row.figures[0].is_none()) {
        return Vec::new();
    }
    match page.varied {
        1 => vec![(page.keys[0].name.clone(), curves(page, pantographs))],
        2 => (1..=pantographs)
            .map(|pantograph| maps(page, pantograph, pantographs))
            .collect(),
        _ => (1..=pantographs)
            .map(|pantograph| parallel(page, pantograph, pantographs))
            .collect(),
    }
}

/// Name of a section, with the pantograph where there are several.
fn heading(what: &str, pantograph: usize, pantographs: usize) -> String {
    if pantographs > 1 {
        format!("{what}, pantograph {pantograph}")
    } else {
        what.to_owned()
    }
}

fn rows(page: &Page, pantograph: usize) -> impl Iterator<Item = &Drawn> {
    page.drawn.iter().filter(move |row| row.pantograph == pantograph)
}

/// Figures over one key.
fn curves(page: &Page, pantographs: usize) -> String {
    let mut plots = Vec::new();
    for (figure, (name, unit)) in FIGURES.iter().enumerate() {
        let traces: Vec<Json> = (1..=pantographs)
            .map(|pantograph| {
                let mut rows: Vec<&Drawn> = rows(page, pantograph).collect();
                let number = |row: &Drawn| row.keys[0].number().unwrap_or(row.case as f64);
                rows.sort_by(|a, b| number(a).total_cmp(&number(b)));
                json!({
                    "type": "scatter",
                    "mode": "lines+markers",
                    "name": format!("pantograph {pantograph}"),
                    "x": rows.iter().map(|row| on_axis(&row.keys[0])).collect::<Vec<_>>(),
                    "y": rows.iter().map(|row| row.figures[figure]).collect::<Vec<_>>(),
                    "text": rows.iter().map(|row| format!("case {}", row.case)).collect::<Vec<_>>(),
                    "line": { "color": COLOURS[(pantograph - 1) % COLOURS.len()] },
                })
            })
            .collect();
        let (title, key) = (in_unit(name, unit), page.keys[0].label());
        let values: Vec<Option<f64>> = page.drawn.iter().map(|row| row.figures[figure]).collect();
        let layout = json!({
            "xaxis": { "title": { "text": key } },
            "yaxis": axis(&title, &values),
            "showlegend": pantographs > 1,
            "hovermode": "closest",
        });
        let name = format!("{title} over {key}");
        plots.push(plot((&format!("curve-{figure}"), &name), HEIGHT, &traces, layout));
    }
    in_pairs(&plots)
}

/// Figures over two keys: a map where they are a grid, else points in colours.
fn maps(page: &Page, pantograph: usize, pantographs: usize) -> (String, String) {
    let rows: Vec<&Drawn> = rows(page, pantograph).collect();
    let distinct = |key: usize| {
        let mut values: Vec<Value> = Vec::new();
        for row in &rows {
            if values.len() <= rows.len() / 2 + 1 && !values.contains(&row.keys[key]) {
                values.push(row.keys[key].clone());
            }
        }
        values.sort_by(|a, b| match (a, b) {
            (Value::Number(a), Value::Number(b)) => a.total_cmp(b),
            _ => std::cmp::Ordering::Equal,
        });
        values
    };
    let (x, y) = (distinct(0), distinct(1));
    let is_grid = x.len() * y.len() <= 2 * rows.len();
    let mut plots = Vec::new();
    for (figure, (name, unit)) in FIGURES.iter().enumerate() {
        let title = in_unit(name, unit);
        let values: Vec<Option<f64>> = rows.iter().map(|row| row.figures[figure]).collect();
        let [least, most] = scale_of_zeros(&values).map_or([None; 2], |ends| ends.map(Some));
        let bar = json!({ "title": { "text": title } });
        let trace = if is_grid {
            let mut z = vec![vec![None; x.len()]; y.len()];
            for row in &rows {
                let place = |values: &[Value], key: usize| values.iter().position(|value| *value == row.keys[key]);
                if let (Some(column), Some(line)) = (place(&x, 0), place(&y, 1)) {
                    z[line][column] = row.figures[figure];
                }
            }
            json!({
                "type": "heatmap",
                "x": x.iter().map(on_axis).collect::<Vec<_>>(),
                "y": y.iter().map(on_axis).collect::<Vec<_>>(),
                "z": z, "zmin": least, "zmax": most,
                "colorscale": SCALE,
                "colorbar": bar,
            })
        } else {
            json!({
                "type": "scatter",
                "mode": "markers",
                "x": rows.iter().map(|row| on_axis(&row.keys[0])).collect::<Vec<_>>(),
                "y": rows.iter().map(|row| on_axis(&row.keys[1])).collect::<Vec<_>>(),
                "text": rows.iter().map(|row| format!("case {}", row.case)).collect::<Vec<_>>(),
                "marker": {
                    "color": values, "cmin": least, "cmax": most,
                    "colorscale": SCALE, "showscale": true, "colorbar": bar, "size": 7,
                },
            })
        };
        let [x, y] = [0, 1].map(|key: usize| page.keys[key].label());
        let layout = json!({
            "xaxis": { "title": { "text": x } },
            "yaxis": upright(&y),
            "hovermode": "closest",
        });
        let name = heading(&format!("{title} over {x} and {y}"), pantograph, pantographs);
        plots.push(plot(
            (&format!("map-{pantograph}-{figure}"), &name),
            HEIGHT,
            &[trace],
            layout,
        ));
    }
    (heading("Maps", pantograph, pantographs), in_pairs(&plots))
}

/// One line per case through all keys and figures, coloured by the standard deviation.
fn parallel(page: &Page, pantograph: usize, pantographs: usize) -> (String, String) {
    let rows: Vec<&Drawn> = rows(page, pantograph).filter(|row| row.figures[0].is_some()).collect();
    let mut dimensions = Vec::new();
    for (key, of) in page.keys.iter().enumerate() {
        if of.is_number {
            let values: Vec<Option<f64>> = rows.iter().map(|row| row.keys[key].number()).collect();
            dimensions.push(json!({ "label": of.label(), "values": values }));
            continue;
        }
        let mut words: Vec<String> = Vec::new();
        let mut values = Vec::new();
        for row in &rows {
            let word = row.keys[key].shown();
            let place = words.iter().position(|known| *known == word).unwrap_or_else(|| {
                words.push(word);
                words.len() - 1
            });
            values.push(place);
        }
        let ticks: Vec<usize> = (0..words.len()).collect();
        dimensions.push(json!({ "label": of.label(), "values": values, "tickvals": ticks, "ticktext": words }));
    }
    for (figure, (name, unit)) in FIGURES.iter().enumerate() {
        let values: Vec<Option<f64>> = rows.iter().map(|row| row.figures[figure]).collect();
        let ends = scale_of_zeros(&values);
        dimensions.push(json!({ "label": in_unit(name, unit), "values": values, "range": ends }));
    }
    let colours: Vec<Option<f64>> = rows.iter().map(|row| row.figures[0]).collect();
    let trace = json!({
        "type": "parcoords",
        "dimensions": dimensions,
        "labelangle": -SLANT,
        "line": {
            "color": colours, "colorscale": SCALE, "showscale": true, "colorbar": { "title": { "text": "σ [N]" } },
        },
    });
    let labels: Vec<String> = page.keys.iter().map(Key::label).collect();
    let longest = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
    let above = 50 + (LETTER * longest as f64 * SLANT.to_radians().sin()) as u32;
    let margin = json!({ "l": 60, "r": 16, "t": above, "b": 30 });
    let name = heading(
        &format!("All figures over {}", labels.join(", ")),
        pantograph,
        pantographs,
    );
    let id = format!("parallel-{pantograph}");
    let html = plot((&id, &name), 450 + above, &[trace], json!({ "margin": margin }));
    let caption = "<p class=\"caption\">One line per case, coloured by the standard deviation of the filtered force. \
                   Drag along an axis to keep a range.</p>\n";
    (heading("Parallel coordinates", pantograph, pantographs), html + caption)
}
