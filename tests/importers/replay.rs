//! The calls of importers that do not install everywhere, in their order and with their arguments, against the core
//! without any FMI in between.
use catenary::Subsystem as Line;
use component::{Causality, Component};
use fmi2::abi::{
    DirectionalDerivativeFn, DoStepFn, FALSE, GetFn, OutputDerivativesFn, PlainFn, SetFn, SetInputDerivativesFn,
    SetStateFn, SetupExperimentFn, StatePointerFn, Status, TRUE, fmi2CallbackFunctions, fmi2Component, fmi2FMUstate,
};
use integration_tests::fmus::{Packaged, THESIS, reference};
use integration_tests::raw::{Identity, Raw};
use integration_tests::runs::rms;
use scene::Scene;
use std::ptr::null_mut;
use std::sync::LazyLock;
use vehicle::Subsystem as Pantograph;

const H: f64 = 1e-3;
const STEPS: usize = 150;

static PAIR: LazyLock<Packaged> = LazyLock::new(|| {
    let short = ["catenary.spans=3", "run.duration=1.0", "run.evaluate={time=[0.0,1.0]}"];
    Packaged::new(THESIS, &short)
});

/// Side of the output (0 the line, 1 the pantograph), side of the input, and the variable of both.
type Connection = (usize, usize, String);

/// The pantograph's strip first: it depends on no input, the line's force depends on it.
fn connections() -> Vec<Connection> {
    let strip = ["x", "y", "z", "vx", "vy", "vz", "roll"].map(|name| (1, 0, format!("strip[1].{name}")));
    let load = ["fx", "fy", "fz", "y"].map(|name| (0, 1, format!("contact[1].{name}")));
    strip.into_iter().chain(load).collect()
}

/// Compared values: contact force in N, height of the strip in m.
type Point = [f64; 2];

/// Side of the coupling without FMI.
trait Core {
    fn output(&mut self, name: &str) -> f64;
    fn rate(&mut self, name: &str) -> f64;
    /// Sets an input and its derivatives at the start of the coming step.
    fn set(&mut self, name: &str, values: &[f64]);
    fn step(&mut self, t: f64, h: f64);
    fn save(&mut self);
    fn restore(&mut self);
}

struct Alone<C: Component> {
    component: C,
    names: Vec<(String, Causality)>,
    saved: C::Checkpoint,
}

impl<C: Component> Alone<C> {
    fn new(scene: &Scene) -> Self {
        let names = C::signals(scene)
            .into_iter()
            .map(|signal| (signal.name, signal.causality));
        Self {
            component: C::build(scene).unwrap(),
            names: names.collect(),
            saved: C::Checkpoint::default(),
        }
    }

    fn position(&self, name: &str, role: Causality) -> usize {
        let found = self
            .names
            .iter()
            .position(|signal| signal.0 == name && signal.1 == role);
        found.unwrap_or_else(|| panic!("no {role:?} {name}"))
    }
}

impl<C: Component> Core for Alone<C> {
    fn output(&mut self, name: &str) -> f64 {
        self.component.output(self.position(name, Causality::Output))
    }

    fn rate(&mut self, name: &str) -> f64 {
        self.component.output_rate(self.position(name, Causality::Output))
    }

    fn set(&mut self, name: &str, values: &[f64]) {
        let at = self.position(name, Causality::Input);
        self.component.set_input(at, values[0]);
        for (order, &value) in values.iter().enumerate().skip(1) {
            self.component.set_input_derivative(at, order, value);
        }
    }

    fn step(&mut self, t: f64, h: f64) {
        self.component.do_step(t, h).unwrap();
    }

    fn save(&mut self) {
        self.component.save(&mut self.saved);
    }

    fn restore(&mut self) {
        self.component.restore(&self.saved).unwrap();
    }
}

fn cores() -> [Box<dyn Core>; 2] {
    let scene = &PAIR.scene;
    [
        Box::new(Alone::<Line>::new(scene)),
        Box::new(Alone::<Pantograph>::new(scene)),
    ]
}

/// Side of the coupling through C functions; each must return `fmi2OK`.
struct Peer<'a> {
    raw: &'a Raw,
    component: fmi2Component,
    state: fmi2FMUstate,
}

impl<'a> Peer<'a> {
    fn new(raw: &'a Raw, name: &str, location: Option<&str>) -> Self {
        let identity = Identity {
            name: Some(name),
            kind: 1,
            guid: Some(&raw.fmu.description().guid),
            location,
            logging: TRUE,
        };
        let component = raw.instantiate(identity, &fmi2CallbackFunctions::default());
        assert!(!component.is_null());
        Self {
            raw,
            component,
            state: null_mut(),
        }
    }

    fn checked(&self, name: &str, status: i32) {
        assert_eq!(
            status,
            Status::Ok as i32,
            "{}: {name}",
            self.raw.fmu.description().model_name
        );
    }

    fn plain(&self, name: &str) {
        // SAFETY: the type is that of the standard, the instance lives.
        self.checked(name, unsafe { self.raw.function::<PlainFn>(name)(self.component) });
    }

    fn set_up(&self, tolerance: f64, meaningless_stop: f64) {
        let name = "fmi2SetupExperiment";
        // SAFETY: as above.
        let status = unsafe {
            self.raw.function::<SetupExperimentFn>(name)(self.component, TRUE, tolerance, 0.0, FALSE, meaningless_stop)
        };
        self.checked(name, status);
    }

    fn references(&self, names: &[&str]) -> Vec<u32> {
        names.iter().map(|name| reference(&self.raw.fmu, name)).collect()
    }

    fn get(&self, names: &[&str]) -> Vec<f64> {
        let (references, mut values) = (self.references(names), vec![0.0; names.len()]);
        let name = "fmi2GetReal";
        // SAFETY: as above; the arrays have the length given and live during the call.
        let status = unsafe {
            self.raw.function::<GetFn<f64>>(name)(self.component, references.as_ptr(), names.len(), values.as_mut_ptr())
        };
        self.checked(name, status);
        values
    }

    fn set(&self, names: &[&str], values: &[f64]) {
        let references = self.references(names);
        let name = "fmi2SetReal";
        // SAFETY: as above.
        let status = unsafe {
            self.raw.function::<SetFn<f64>>(name)(self.component, references.as_ptr(), names.len(), values.as_ptr())
        };
        self.checked(name, status);
    }

    fn set_derivatives(&self, names: &[&str], order: i32, values: &[f64]) {
        let (references, orders) = (self.references(names), vec![order; names.len()]);
        let name = "fmi2SetRealInputDerivatives";
        // SAFETY: as above.
        let status = unsafe {
            self.raw.function::<SetInputDerivativesFn>(name)(
                self.component,
                references.as_ptr(),
                names.len(),
                orders.as_ptr(),
                values.as_ptr(),
            )
        };
        self.checked(name, status);
    }

    fn rates(&self, names: &[&str]) -> Vec<f64> {
        let (references, orders, mut values) = (self.references(names), vec![1; names.len()], vec![0.0; names.len()]);
        let name = "fmi2GetRealOutputDerivatives";
        // SAFETY: as above.
        let status = unsafe {
            self.raw.function::<OutputDerivativesFn>(name)(
                self.component,
                references.as_ptr(),
                names.len(),
                orders.as_ptr(),
                values.as_mut_ptr(),
            )
        };
        self.checked(name, status);
        values
    }

    /// Derivatives of outputs for one input.
    fn column(&self, outputs: &[&str], input: &str) -> Vec<f64> {
        let (unknowns, known) = (self.references(outputs), self.references(&[input]));
        let mut values = vec![0.0; outputs.len()];
        let name = "fmi2GetDirectionalDerivative";
        // SAFETY: as above.
        let status = unsafe {
            self.raw.function::<DirectionalDerivativeFn>(name)(
                self.component,
                unknowns.as_ptr(),
                unknowns.len(),
                known.as_ptr(),
                1,
                [1.0].as_ptr(),
                values.as_mut_ptr(),
            )
        };
        self.checked(name, status);
        values
    }

    fn step(&self, t: f64, h: f64) {
        let name = "fmi2DoStep";
        // SAFETY: as above. `TRUE` is what most importers pass, also those that go back to this very point.
        let status = unsafe { self.raw.function::<DoStepFn>(name)(self.component, t, h, TRUE) };
        self.checked(name, status);
    }

    /// Keeps the state in the handle of the last time.
    fn save(&mut self) {
        let name = "fmi2GetFMUstate";
        // SAFETY: as above; the handle is null or one of this instance.
        let status = unsafe { self.raw.function::<StatePointerFn>(name)(self.component, &raw mut self.state) };
        self.checked(name, status);
    }

    fn restore(&self) {
        let name = "fmi2SetFMUstate";
        // SAFETY: as above.
        let status = unsafe { self.raw.function::<SetStateFn>(name)(self.component, self.state) };
        self.checked(name, status);
    }

    fn micro_steps(&self) -> i32 {
        let (references, mut value) = (self.references(&["solver.micro_steps"]), 0);
        let name = "fmi2GetInteger";
        // SAFETY: as above.
        let status =
            unsafe { self.raw.function::<GetFn<i32>>(name)(self.component, references.as_ptr(), 1, &raw mut value) };
        self.checked(name, status);
        value
    }
}

impl Drop for Peer<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is null, which is ignored, or one of this instance; the instance is not used again.
        unsafe {
            self.raw.function::<StatePointerFn>("fmi2FreeFMUstate")(self.component, &raw mut self.state);
            self.raw.free(self.component);
        }
    }
}

fn raws() -> [Raw; 2] {
    ["Catenary", "Pantograph"].map(|identifier| Raw::new(PAIR.open(identifier)))
}

fn point(force: f64, height: f64) -> Point {
    [force, height]
}

/// The contact force that inputs set since the step do not change, and the height.
fn recorded(peers: &[Peer<'_>; 2]) -> Point {
    point(
        peers[0].get(&["contact[1].sample[10]"])[0],
        peers[1].get(&["strip[1].z"])[0],
    )
}

fn recorded_core(cores: &mut [Box<dyn Core>; 2]) -> Point {
    point(cores[0].output("contact[1].sample[10]"), cores[1].output("strip[1].z"))
}

fn column(points: &[Point], which: usize) -> Vec<f64> {
    points.iter().map(|point| point[which]).collect()
}

/// OMSimulator with `--inputExtrapolation=true`: each step is taken back once, and only derivatives are set anew.
fn as_omsimulator(peers: &mut [Peer<'_>; 2]) -> Vec<Point> {
    let connections = connections();
    let update = |peers: &[Peer<'_>; 2], derivatives: bool| {
        for (from, to, name) in &connections {
            let value = peers[*from].get(&[name])[0];
            peers[*to].set(&[name], &[value]);
            if derivatives {
                let rate = peers[*from].rates(&[name])[0];
                peers[*to].set_derivatives(&[name], 1, &[rate]);
            }
        }
    };
    let inputs = |peers: &[Peer<'_>; 2]| -> Vec<f64> {
        connections
            .iter()
            .map(|(_, to, name)| peers[*to].get(&[name])[0])
            .collect()
    };
    for peer in peers.iter() {
        peer.set_up(1e-4, 1.0);
        peer.plain("fmi2EnterInitializationMode");
    }
    update(peers, false);
    for peer in peers.iter() {
        peer.plain("fmi2ExitInitializationMode");
    }
    update(peers, true);
    let (mut t, mut points) = (0.0, Vec::new());
    for _ in 0..STEPS {
        let next = t + H; // adds up, as it does there
        let h = next - t;
        peers.iter_mut().for_each(Peer::save);
        let before = inputs(peers);
        peers.iter().for_each(|peer| peer.step(t, h));
        update(peers, true);
        let slopes: Vec<f64> = inputs(peers).iter().zip(&before).map(|(b, a)| (b - a) / h).collect();
        peers.iter().for_each(Peer::restore);
        for ((_, to, name), &slope) in connections.iter().zip(&slopes) {
            peers[*to].set_derivatives(&[name], 1, &[slope]);
        }
        peers.iter().for_each(|peer| peer.step(t, h));
        points.push(recorded(peers));
        update(peers, true);
        t = next;
    }
    points
}

/// The scheme without FMI: inputs are straight lines to their ends in a step taken under the first slopes.
fn straight_lines(cores: &mut [Box<dyn Core>; 2]) -> Vec<Point> {
    let connections = connections();
    let update = |cores: &mut [Box<dyn Core>; 2]| -> (Vec<f64>, Vec<f64>) {
        let values = connections.iter().map(|(from, to, name)| {
            let (value, rate) = (cores[*from].output(name), cores[*from].rate(name));
            cores[*to].set(name, &[value, rate]);
            (value, rate)
        });
        values.unzip()
    };
    let (mut values, _) = update(cores);
    let mut points = Vec::new();
    let mut t = 0.0;
    for _ in 0..STEPS {
        let next = t + H;
        let h = next - t;
        cores.iter_mut().for_each(|core| core.save());
        cores.iter_mut().for_each(|core| core.step(t, h));
        let (ends, _) = update(cores);
        cores.iter_mut().for_each(|core| core.restore());
        for (((_, to, name), &value), &end) in connections.iter().zip(&values).zip(&ends) {
            cores[*to].set(name, &[value, (end - value) / h]);
        }
        cores.iter_mut().for_each(|core| core.step(t, h));
        points.push(recorded_core(cores));
        (values, _) = update(cores);
        t = next;
    }
    points
}

#[test]
fn calls_in_omsimulators_order_give_the_trajectory_of_its_scheme() {
    let raws = raws();
    // Four slashes and not encoded, although the folder's name has a space and a percent sign.
    let locations = [0, 1].map(|k: usize| format!("file:///{}", raws[k].fmu.folder().join("resources").display()));
    let mut peers = [0, 1].map(|k: usize| Peer::new(&raws[k], "model.root.x", Some(&locations[k])));
    let replayed = as_omsimulator(&mut peers);
    let expected = straight_lines(&mut cores());
    assert_eq!(replayed, expected);
    let force = column(&expected, 0);
    assert!(
        force.iter().any(|force| (force - expected[0][0]).abs() > 5.0),
        "the force moves"
    );
    // Work is counted, also that which was taken back.
    assert_eq!(peers.each_ref().map(Peer::micro_steps), [2 * STEPS as i32; 2]);
}

/// Inputs over a step of PyFMI's master with `extrapolation_order = 2` and `smooth_coupling`: continuous, they reach at
/// the step's end what the present values and slopes foretell.
struct Smooth {
    value: Vec<f64>,
    slope: Option<Vec<f64>>,
    output_rates: Option<Vec<f64>>,
}

impl Smooth {
    /// Value, slope and curvature of each input.
    fn next(&mut self, h: f64, outputs: &[f64], rates: &[f64]) -> Vec<Vec<f64>> {
        let reached: Vec<f64> = (0..outputs.len())
            .map(|k| self.value[k] + h * self.slope.as_ref().map_or(0.0, |slope| slope[k]))
            .collect();
        let slope: Vec<f64> = (0..outputs.len())
            .map(|k| (outputs[k] - reached[k]) / h + rates[k])
            .collect();
        let curved = self.output_rates.as_ref().map(|before| {
            let second = rates.iter().zip(before).map(|(b, a)| (b - a) / H);
            second.collect::<Vec<f64>>()
        });
        self.output_rates = Some(rates.to_vec());
        self.value.clone_from(&reached);
        self.slope = Some(slope.clone());
        (0..outputs.len())
            .map(|k| {
                let mut values = vec![reached[k], slope[k]];
                values.extend(curved.as_ref().map(|curved| curved[k]));
                values
            })
            .collect()
    }
}

/// Names of the outputs of one side, as one array.
fn outputs_of(connections: &[Connection], side: usize) -> Vec<&str> {
    let own = connections.iter().filter(|connection| connection.0 == side);
    own.map(|connection| connection.2.as_str()).collect()
}

/// PyFMI: outputs, rates and directional derivatives in arrays, inputs with first and second derivatives, differences
/// of times as step sizes.
fn as_pyfmi(peers: &mut [Peer<'_>; 2]) -> Vec<Point> {
    let connections = connections();
    let outputs = [outputs_of(&connections, 0), outputs_of(&connections, 1)];
    for peer in peers.iter() {
        peer.set_up(1e-6, 0.01);
        peer.plain("fmi2EnterInitializationMode");
    }
    let jacobian = |peers: &[Peer<'_>; 2]| {
        for side in 0..2 {
            for input in &outputs[1 - side] {
                peers[side].column(&outputs[side], input);
            }
        }
    };
    let everything = |peers: &[Peer<'_>; 2]| [peers[0].get(&outputs[0]), peers[1].get(&outputs[1])];
    // A root finder looks for values that both sides agree on.
    for _ in 0..3 {
        let found = everything(peers);
        for side in 0..2 {
            peers[1 - side].set(&outputs[side], &found[side]);
        }
        jacobian(peers);
    }
    for peer in peers.iter() {
        peer.plain("fmi2ExitInitializationMode");
    }
    let mut inputs = everything(peers).map(|value| Smooth {
        value,
        slope: None,
        output_rates: None,
    });
    let mut points = Vec::new();
    for n in 0..STEPS {
        let t = n as f64 * H;
        let h = (n + 1) as f64 * H - t;
        peers.iter().for_each(|peer| peer.step(t, h));
        let found = everything(peers);
        points.push(recorded(peers));
        let rates = [0, 1].map(|side: usize| peers[side].rates(&outputs[side]));
        jacobian(peers);
        for side in 0..2 {
            let next = inputs[side].next(H, &found[side], &rates[side]);
            let order = |k: usize| next.iter().map(|values| values[k]).collect::<Vec<f64>>();
            let partner = &peers[1 - side];
            partner.set(&outputs[side], &order(0));
            for k in 1..next[0].len() {
                partner.set_derivatives(&outputs[side], k as i32, &order(k));
            }
        }
    }
    points
}

/// The scheme of PyFMI with the same steps throughout.
fn smooth_inputs(cores: &mut [Box<dyn Core>; 2]) -> Vec<Point> {
    let connections = connections();
    let outputs = [outputs_of(&connections, 0), outputs_of(&connections, 1)];
    let everything = |cores: &mut [Box<dyn Core>; 2]| {
        [0, 1].map(|side: usize| {
            outputs[side]
                .iter()
                .map(|name| cores[side].output(name))
                .collect::<Vec<f64>>()
        })
    };
    for _ in 0..3 {
        let found = everything(cores);
        for side in 0..2 {
            for (name, &value) in outputs[side].iter().zip(&found[side]) {
                cores[1 - side].set(name, &[value]);
            }
        }
    }
    let mut inputs = everything(cores).map(|value| Smooth {
        value,
        slope: None,
        output_rates: None,
    });
    let mut points = Vec::new();
    for n in 0..STEPS {
        cores.iter_mut().for_each(|core| core.step(n as f64 * H, H));
        let found = everything(cores);
        points.push(recorded_core(cores));
        let rates = [0, 1].map(|side: usize| {
            let rates = outputs[side].iter().map(|name| cores[side].rate(name));
            rates.collect::<Vec<f64>>()
        });
        for side in 0..2 {
            let next = inputs[side].next(H, &found[side], &rates[side]);
            for (name, values) in outputs[side].iter().zip(&next) {
                cores[1 - side].set(name, values);
            }
        }
    }
    points
}

#[test]
fn calls_in_pyfmis_order_give_the_trajectory_of_its_scheme() {
    let raws = raws();
    let mut peers = [0, 1].map(|k: usize| Peer::new(&raws[k], "Model", None));
    let replayed = as_pyfmi(&mut peers);
    let expected = smooth_inputs(&mut cores());
    let steps: Vec<f64> = (0..STEPS).map(|n| (n + 1) as f64 * H - n as f64 * H).collect();
    assert!(
        steps.iter().any(|&h| h > H) && steps.iter().any(|&h| h < H),
        "step sizes with rounding errors"
    );
    let forces = [column(&replayed, 0), column(&expected, 0)];
    let mean = forces[1].iter().sum::<f64>() / STEPS as f64;
    let sigma = rms(&forces[1], &[mean; STEPS]);
    let difference = rms(&forces[0], &forces[1]);
    assert!(
        sigma > 1.0 && difference < 1e-6 * sigma,
        "{difference} N, sigma {sigma} N"
    );
    assert!(rms(&column(&replayed, 1), &column(&expected, 1)) < 1e-10);
    // Rounding errors of the step size make no extra internal step.
    assert_eq!(peers.each_ref().map(Peer::micro_steps), [STEPS as i32; 2]);
    let (force, end) = (replayed[STEPS - 1][0], peers[1].get(&["strip[1].z"])[0]);
    assert!(force.is_finite() && end.is_finite());
    peers.iter().for_each(|peer| peer.plain("fmi2Terminate"));
}
