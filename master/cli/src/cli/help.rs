//! Texts at the end of helps.

use experiments::engine::table::STATUS_RULE;
use simulation::SETTLE;

/// Exit statuses of every command but `run`.
pub(crate) const EXIT_STATUS: &str = "Exit status: 0 done, 1 not completed, 2 wrong usage, scene or FMU.";

/// Exit statuses of `run`, and of the program as a whole.
pub(crate) const RUN_STATUS: &str = "Exit status: 0 done, 1 not completed (results up to there are written and \
    marked incomplete), \
     2 wrong usage, scene or FMU (nothing is written), 3 done, but a limit fails and --fail-on-limits was given.";

/// End of the help of `compare`.
pub(crate) fn compare_help() -> String {
    format!(
        "Runs: monolithic; with FMUs every algorithm at every macro step; in process the automatic choice. One at a \
         time, so that \
         wall times can be compared. They end when the last strip has left the evaluation range and the low-pass \
         filter has \
         settled ({SETTLE} periods of its cut-off).\n\n\
         Micro steps: only the coupling shall differ, so a coupled run and its monolithic reference have the same \
         micro step, \
         never longer than a macro step compared with it. Macro steps from half the scene's micro step on share one, \
         that of the \
         scene or the smallest of them; shorter ones are taken in groups that span less than a factor of five, each \
         at its \
         smallest and with its own reference. With a micro step of 1 ms in the scene, the default list makes two \
         groups: 0.5 to \
         10 ms at 0.5 ms, and 0.1 and 0.2 ms at 0.1 ms. `--set solver.micro_step=…` shortens all of them.\n\n\
         Keys: order, force and extrapolation of the scene belong to the algorithm that it names, the others run \
         with their own \
         defaults; `--set coupling.…` holds for all.\n\n\
         Status: {STATUS_RULE}.\n\n\
         compare.csv is written after every run; rows without a status have not been run.\n\n\
         {EXIT_STATUS}"
    )
}

/// End of the help of `study`.
pub(crate) fn study_help() -> String {
    format!(
        "Reference: elements doubled and micro step halved until two successive levels agree within the tolerance; \
         the nonlinear \
         line with two meshes (corrected and plain), which confirm each other. Their last difference is stated as \
         what is not known \
         of the reference. Linearised and flat lines have references of their own.\n\n\
         Runs: a base case that resolves the waves ahead of the pantograph and the band of the low-pass filter; \
         sweeps that \
         change one thing of it; where the scene has a vehicle, every model of it that the scene has what it needs \
         for, on its track \
         and, where that is smooth, on one with irregularities of the lower level of ORE B176; a ladder of balanced \
         recipes \
         for each class of reductions. They end when the last strip has left the evaluation range and the low-pass \
         filter has settled ({SETTLE} periods of its cut-off).\n\n\
         Errors are computed on all cores at once, wall times one run at a time afterwards. Every run is kept in the \
         folder study \
         of the output directory: a study that was ended goes on where it was, with the same program.\n\n\
         Status: {STATUS_RULE}.\n\n\
         {EXIT_STATUS}"
    )
}

/// End of the help of `sweep`.
pub(crate) fn sweep_help() -> String {
    format!(
        "Values: `--vary run.speed_kmh=200:320:10` takes every tenth number, the end too where steps meet it; \
         `--vary contact.stiffness=3e4,5e4` these. All combinations are cases, the last key changing first. With \
         `--sample latin`, `sobol` or `random`, `--count N` and `--seed S` every key is sampled: from a:b (uniform), \
         uniform(a,b), log_uniform(a,b), normal(mean,std), lognormal(median,sigma), choice(v1,v2), or a list.\n\n\
         Keys are those of `--set`, checked as there. A plain name, without a dot, is a number for expressions: \
         `--vary force=100:140:20 --derive pantograph[1].static_force=force`. Expressions take varied and derived \
         values, numbers of the scene by their keys, + - * / % ^, comparisons, && || not(), min max abs sqrt exp ln \
         log10 sin cos tan floor ceil round, pi.\n\n\
         SWEEP.toml: scene, mode, series, where, and the tables set, vary, derive and sample; options of the command \
         line take the place of its values.\n\n\
         Rows: one per case and pantograph, in the order of the plan, the same for any number of jobs; wall times are \
         in sweep-times.csv. A case that fails is a row with its reason. A sweep that was ended goes on with the same \
         command and program; another sweep in the same directory is refused.\n\n\
         {EXIT_STATUS} Done: every case has a status."
    )
}

/// End of the help of `stability`.
pub(crate) fn stability_help() -> String {
    format!(
        "Every case is run as one system, in process with every coupling algorithm, and with the automatic choice \
         through FMUs.\n\n\
         Status: {STATUS_RULE}.\n\n\
         References: a coupled run is compared with the monolithic one at the same micro step, the monolithic one \
         with itself \
         at half the micro step. The monolithic one is also limit where the time integration made more than 1 % of \
         the energy \
         exchanged; a coupled one is at most limit where the monolithic one is. A run that is not stable is repeated \
         with other \
         values of what makes it hard, or with its step halved up to three times: where it becomes stable is its \
         boundary.\n\n\
         Without --cases and --quick the boundaries are mapped by bisection: macro step against contact stiffness, \
         head mass and \
         speed, micro step against contact stiffness.\n\n\
         Runs are made side by side, one per core: they have no wall times, and the table is the same for any number \
         of cores.\n\n\
         {EXIT_STATUS}"
    )
}

/// End of the help of `reproduce`.
pub(crate) fn reproduce_help() -> String {
    format!(
        "thesis: S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of \
         Illinois at Chicago, \
     2016.\n\n\
     Runs: the four published cases as their scenes have them, the first one through FMUs too; all four on meshes of \
     18, 36 and 72 \
     elements per span and on a converged one; and every quantity that the thesis leaves open over its plausible \
     range, one at a \
     time, on the thesis' mesh and, where it can matter there, on the converged one. Nothing is tuned to a published \
     value. `--set` \
     holds for all runs.\n\n\
     Runs are made side by side, one per core: their wall times are no measure of speed. reproduction.csv is written \
     after every \
     run; rows without a status have not been run. Behind the runs it says what they are worth: a row of group \
     `relation` for each \
     published change on each mesh, published and computed, and whether it holds; a row of group `spread` for each \
     open quantity on each \
     mesh, its smallest and largest standard deviation and whether the published one lies inside.\n\n\
     {EXIT_STATUS}"
    )
}
