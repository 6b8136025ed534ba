//! The animation of line and pantograph.

use serde::Serialize;

use super::label::NamedRun;
use super::{escape, pack};
use component::Frame;

/// The player: draws the frames on a canvas.
const PLAYER: &str = include_str!("animation.js");

#[derive(Serialize)]
struct Film {
    label: String,
    supports: Vec<f64>,
    frames: Vec<Frame>,
}

/// The section with the player; empty where no run has pictures.
pub(super) fn section(runs: &[NamedRun<'_>]) -> String {
    let films: Vec<Film> = runs
        .iter()
        .filter(|run| !run.record.animation.frames.is_empty())
        .map(|run| Film {
            label: run.label.clone(),
            supports: run.record.line.support_x.clone(),
            frames: run.record.animation.rounded().frames,
        })
        .collect();
    if films.is_empty() {
        return String::new();
    }
    // Numbers and strings always serialise: keys are strings and NaN becomes null.
    let data = pack::data(&serde_json::to_string(&films).unwrap_or_default(), "id=\"films\"");
    let options: String = films
        .iter()
        .enumerate()
        .map(|(i, film)| format!("<option value=\"{i}\">{}</option>", escape(&film.label)))
        .collect();
    let hidden = if films.len() == 1 { " hidden" } else { "" };
    format!(
        "<div class=\"player\" id=\"player\">\n\
         <canvas aria-label=\"Line and pantograph seen from the side\"></canvas>\n\
         <p class=\"readout\" data-role=\"readout\"></p>\n\
         <div class=\"bar\">\n\
         <button type=\"button\" data-role=\"play\">Play</button>\n\
         <input type=\"range\" min=\"0\" max=\"1000\" value=\"0\" step=\"1\" data-role=\"time\" aria-label=\"Time\">\n\
         <label>Speed <select data-role=\"speed\"><option value=\"0.05\">1/20</option>\
         <option value=\"0.2\">1/5</option><option value=\"1\" selected>real</option></select></label>\n\
         <label>Heights <select data-role=\"exaggeration\"><option value=\"0\" selected>fit</option>\
         <option value=\"1\">1×</option><option value=\"5\">5×</option><option value=\"10\">10×</option>\
         <option value=\"20\">20×</option><option value=\"50\">50×</option></select></label>\n\
         <label>View <select data-role=\"view\"><option value=\"30\">30 m</option>\
         <option value=\"60\">60 m</option><option value=\"120\" selected>120 m</option>\
         <option value=\"240\">240 m</option><option value=\"0\">whole line</option></select></label>\n\
         <label{hidden}>Run <select data-role=\"run\">{options}</select></label>\n\
         </div>\n\
         <p class=\"caption\">\
         <span class=\"entry\"><span class=\"key\" style=\"color:#1f5fa8\"></span>contact wire</span> \
         <span class=\"entry\"><span class=\"key\" style=\"color:#5b6675\"></span>messenger wire</span> \
         <span class=\"entry\"><span class=\"key\" style=\"color:#8b95a3\"></span>dropper</span> \
         <span class=\"entry\"><span class=\"key\" style=\"color:#d1661b\"></span>slack dropper</span> \
         <span class=\"entry\"><span class=\"key\" style=\"color:#1d7a46\"></span>pantograph</span></p>\n\
         </div>\n{data}\
         <script>\n{PLAYER}</script>\n"
    )
}
