"""Functions and methods that look at links and robots and leave them as they are."""

from __future__ import annotations

_FUNCTIONS_TEXT = """
    print disp display fprintf sprintf printf pprint mprint str repr type class isinstance isa
    len length numel size ndims isempty any all abs id hash vars dir help doc whos who plot
    plot3 plot3d teach vellipse fellipse animate show showdetails figure axis view hold fkine
    fkine_all fkine_path ikine ikine6s ikcon ikunc ikine_sym ikine_LM ikine_LMS ikine_a
    ikine_min ikine_mmc ikine_GN ikine_NR ikine_QP ik_LM ik_GN ik_NR jacob0 jacobn jacobe
    jacob_dot jacob0_dot jacobm hessian0 hessiane manipulability maniplty rne rne_mex gravload
    inertia coriolis accel fdyn friction cinertia paycap payload_of jtraj ctraj mstraj tranimate
    trplot dyn dynchanged isspherical isconfig islimit isprismatic isrevolute isdh ismdh issym
    char islimit todegrees toradians getpos inverseKinematics analyticalInverseKinematics
    generalizedInverseKinematics getTransform geometricJacobian homeConfiguration
    randomConfiguration checkCollision interactiveRigidBodyTree massMatrix centerOfMass
    gravityTorque getBody addconfiguration addconfiguration_attr addconfig configurations_str
    dynamics segments hasdynamics iscollided ets twists trchain A gencoords genforces tic toc
    pause input rand randn linspace zeros ones
"""
FUNCTIONS = frozenset(_FUNCTIONS_TEXT.split())
"""By the last part of their names, called with a link or robot, or as methods of one."""

_WORDS_TEXT = """
    clc close format hold grid axis figure clf more tic toc pause startup_rvc startup_rtb
    drawnow view title xlabel ylabel zlabel legend echo disp beep commandwindow warning rtbdemo
    pkg diary end return quit exit rotate3d xlim ylim zlim colorbar subplot shg
"""
WORDS = frozenset(_WORDS_TEXT.split())
"""Bare words of MATLAB that are statements."""
COMMANDS = WORDS | {"addpath", "colormap", "load", "run", "savepath"}
"""Words of MATLAB that take words after them."""

_ROBOT_NOTES_TEXT = """
    name manufacturer manuf comment plotopt plotopt3d gravity fast ikineType model3d faces
    points trail delay movie interface configs symbolic keywords meshdir basemesh q qd qdd
    control_mode qz qr qn qs qd_ home lineopt shadowopt handle logo shape DataFormat Gravity
    BaseName
"""
ROBOT_NOTES = frozenset(_ROBOT_NOTES_TEXT.split())
"""Attributes of robots that do not move them."""

_LINK_NOTES_TEXT = """
    m r I Jm G B Tc jm g tc mesh i b name geometry collision id number jindex parent robot Mass
    CenterOfMass Inertia
"""
LINK_NOTES = frozenset(_LINK_NOTES_TEXT.split())
"""Attributes of links that do not move them."""
