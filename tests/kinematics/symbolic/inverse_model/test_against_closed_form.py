"""The printed functions, run, have the solutions and postures of the service's closed forms."""

import shutil
import subprocess
from functools import partial

import numpy as np
import pytest

from kinematics.symbolic import Notation
from robots.robot import robot_from_table
from robots.shipped import shipped_robot
from tests.kinematics.symbolic.formulas import written
from tests.kinematics.symbolic.inverse_model.arms import CLASSES, SWIVEL, Judge, random_table

ARMS = ("puma560", "ur5", "stanford", "scara", "rx90", "kr6_r900", "fanuc_m10ia", "planar_2r")
ARMS += ("planar_3r", "abb_irb140", "ur10e", "iiwa14", "pa10")
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
OCTAVE = shutil.which("octave-cli") or shutil.which("octave")


def python_function(table, **options):
    """``inverse_model`` of the printed module, at ``SWIVEL`` where it takes a swivel angle."""
    code = written(table, "inverse", notation=Notation.PYTHON, **options)["code"]
    scope = {}
    exec(compile(code, "printed", "exec"), scope)
    function = scope["inverse_model"]
    return partial(function, swivel=SWIVEL) if "swivel=0.0" in code else function


def pairs(found):
    return [(one["q"], one["posture"]) for one in found]


@pytest.mark.parametrize("parameters", ["symbolic", "numeric"])
@pytest.mark.parametrize("name", ARMS)
def test_python_of_known_arms(name, parameters):
    robot = shipped_robot(name)
    judge, function = Judge(robot), python_function(robot.table, parameters=parameters)
    for T in judge.targets(10, seed=1):
        judge.check(T, pairs(function(T.tolist())))


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_python_of_known_arms_at_a_thousand_poses(name):
    robot = shipped_robot(name)
    judge, function = Judge(robot), python_function(robot.table, parameters="symbolic")
    for T in judge.targets(1000, seed=2):
        judge.check(T, pairs(function(T.tolist())))


@pytest.mark.parametrize("any_twist", [False, True])
@pytest.mark.parametrize("name", CLASSES)
def test_python_of_random_tables(name, any_twist):
    for seed in range(3):
        table = random_table(name, seed, any_twist=any_twist)
        judge, function = Judge(robot_from_table(table)), python_function(table)
        for T in judge.targets(4, seed):
            judge.check(T, pairs(function(T.tolist())))


@pytest.mark.slow
@pytest.mark.parametrize("name", CLASSES)
def test_python_of_many_random_tables(name):
    for seed in range(3, 23):
        table = random_table(name, seed, any_twist=seed % 2 == 0)
        judge = Judge(robot_from_table(table))
        function = python_function(table, parameters=("numeric", "symbolic")[seed % 2])
        for T in judge.targets(10, seed):
            judge.check(T, pairs(function(T.tolist())))


MAIN = """
#include <stdio.h>
int main(void)
{
    double T[4][4], given[%(dof)d] = {0};
    inverse_solution out[%(most)d];
    for (;;) {
        for (int i = 0; i < 16; i++) if (scanf("%%lf", &T[i/4][i%%4]) != 1) return 0;
        const int count = inverse_model(T, %(lengths)sgiven, %(swivel)sout);
        printf("%%d\\n", count);
        for (int n = 0; n < count; n++) {
            for (int i = 0; i < %(dof)d; i++) printf("%%.17g ", out[n].q[i]);
            for (int i = 0; i < %(choices)d; i++) printf("%%s ", out[n].posture[i]);
            printf("\\n");
        }
    }
}
"""


def c_solutions(table, targets, folder, parameters):
    """What the printed C finds for each target."""
    answer = written(table, "inverse", notation=Notation.C, parameters=parameters)
    code = answer["code"]
    signature = code.split("int inverse_model(")[1].split(")")[0]
    takes_swivel = "double swivel" in signature
    last = -3 if takes_swivel else -2
    names = [part.split()[-1] for part in signature.split(",")[1:last]]
    values = {
        "dof": table.dof,
        "most": int(signature.split("out[")[1].rstrip("]")),
        "choices": int(code.split("*posture[")[1].split("]")[0]),
        "lengths": "".join(f"{answer['values'][name]!r}, " for name in names),
        "swivel": f"{SWIVEL}, " if takes_swivel else "",
    }
    source, program = folder / "printed.c", folder / "printed"
    source.write_text(f"{code}{MAIN % values}")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-unused-variable"]
    subprocess.run([COMPILER, *flags, str(source), "-o", str(program), "-lm"], check=True)
    given = "\n".join(" ".join(map(repr, T.ravel().tolist())) for T in targets)
    run = subprocess.run([program], input=given, capture_output=True, text=True, check=True)
    lines = iter(run.stdout.splitlines())
    found = []
    for line in lines:
        rows = [next(lines).split() for _ in range(int(line))]
        dof = table.dof
        found.append([([float(cell) for cell in row[:dof]], row[dof:]) for row in rows])
    return found


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize("name", ["puma560", "ur5", "stanford", "scara", "rx90", "kr6_r900"])
def test_c_of_known_arms(name, tmp_path):
    robot = shipped_robot(name)
    judge = Judge(robot)
    targets = judge.targets(20, seed=3)
    parameters = "symbolic" if name in ("puma560", "ur5", "rx90") else "numeric"
    found = c_solutions(robot.table, targets, tmp_path, parameters)
    assert len(found) == len(targets)
    for T, one in zip(targets, found, strict=True):
        judge.check(T, one)


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize("name", CLASSES)
def test_c_of_random_tables(name, tmp_path):
    table = random_table(name, seed=4)
    judge = Judge(robot_from_table(table))
    targets = judge.targets(10, seed=5)
    for T, one in zip(targets, c_solutions(table, targets, tmp_path, "numeric"), strict=True):
        judge.check(T, one)


SCRIPT = """
targets = dlmread('targets.txt');
for n = 1:rows(targets)
    found = inverse_model(reshape(targets(n, :), 4, 4)'ARGUMENTS);
    printf('%d\\n', numel(found));
    for i = 1:numel(found)
        printf('%.17g ', found(i).q);
        printf('%s ', found(i).posture{:});
        printf('\\n');
    end
end
"""


def matlab_solutions(table, targets, folder):
    """What the printed MATLAB finds for each target, run by GNU Octave."""
    code = written(table, "inverse", notation=Notation.MATLAB, parameters="symbolic")["code"]
    (folder / "inverse_model.m").write_text(code)
    more = f", zeros(1, {table.dof}), {SWIVEL}" if "swivel" in code else ""
    (folder / "main.m").write_text(SCRIPT.replace("ARGUMENTS", more))
    np.savetxt(folder / "targets.txt", targets.reshape(-1, 16), fmt="%.17g")
    command = [OCTAVE, "--no-gui", "--quiet", "--norc", "main.m"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    lines = iter(run.stdout.splitlines())
    found = []
    for line in lines:
        rows = [next(lines).split() for _ in range(int(line))]
        dof = table.dof
        found.append([([float(cell) for cell in row[:dof]], row[dof:]) for row in rows])
    return found


@pytest.mark.skipif(OCTAVE is None, reason="no GNU Octave")
@pytest.mark.parametrize("name", ["puma560", "ur5", "stanford", "scara", "rx90", "kr6_r900"])
def test_matlab_of_known_arms(name, tmp_path):
    robot = shipped_robot(name)
    judge = Judge(robot)
    targets = judge.targets(10, seed=6)
    for T, one in zip(targets, matlab_solutions(robot.table, targets, tmp_path), strict=True):
        judge.check(T, one)


@pytest.mark.skipif(OCTAVE is None, reason="no GNU Octave")
@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.slow
def test_matlab_of_random_tables(name, tmp_path):
    table = random_table(name, seed=7)
    judge = Judge(robot_from_table(table))
    targets = judge.targets(5, seed=8)
    for T, one in zip(targets, matlab_solutions(table, targets, tmp_path), strict=True):
        judge.check(T, one)
