"""Who is measured, ours first."""

from bench.peers import closed, descent, native, ours, toolbox
from bench.peers.peer import Peer

PEERS = [
    Peer("denavit", "denavit", ours.denavit, "`solve_ik`, default options"),
    Peer("pinocchio-lm", "pin", ours.plain, "`solve_on_pinocchio`: the same in plain Python"),
    Peer(
        "roboticstoolbox",
        "roboticstoolbox-python",
        toolbox.toolbox,
        "`ETS.ik_LM` (C++), tol=1e-13, its 30 iterations and 100 searches",
    ),
    Peer(
        "eaik",
        "eaik",
        closed.eaik,
        "closed form, nearest within limits; 7 joints: one locked at up to 51 values",
    ),
    Peer(
        "ssik",
        "ssik",
        closed.ssik,
        "module of `ssik build`, native, the solution nearest to the seed",
    ),
    Peer("optik", "optik-py", native.optik, "speed, at most 0.1 s, one thread, tol_f=1e-13"),
    Peer(
        "pytracik",
        "pytracik",
        native.pytracik,
        "TRAC-IK, Speed, at most 0.1 s, its two threads, eps=1e-7",
    ),
    Peer(
        "cartan", "cartan-bindings", native.cartan_race, "`solve_ik`, tolerances 1e-7, 5100 steps"
    ),
    Peer(
        "cartan-speed",
        "cartan-bindings",
        native.cartan_speed,
        "`solve_ik_speed`, tolerances 1e-7, 5100 steps",
    ),
    Peer("dynibo", "dynibo", native.dynibo, "tolerances 1e-7, up to 50 random restarts"),
    Peer("pink", "pin-pink", descent.pink, "steps of `solve_ik` (daqp) to 1e-7, up to 50 restarts"),
    Peer("mink", "mink", descent.mink, "steps of `solve_ik` (daqp) to 1e-7, up to 50 restarts"),
    Peer("ikpy", "ikpy", descent.ikpy, "`inverse_kinematics_frame`, tol=1e-13, up to 50 restarts"),
]
