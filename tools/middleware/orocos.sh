# shellcheck shell=bash
# omniORB, which OROCOS uses, and its name server. There are no packages of OROCOS itself.

need_packages omniorb omniorb-nameserver omniidl libomniorb4-dev g++
