# shellcheck shell=bash
# omniORB, which OROCOS speaks with, and its name server. OROCOS itself is in no
# registry of packages.

need_packages omniorb omniorb-nameserver omniidl libomniorb4-dev g++
