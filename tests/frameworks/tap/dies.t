#!/usr/bin/perl
# Ends before its plan is complete.
use strict;
use warnings;
use Test::More tests => 3;
ok( 1, 'first' );
die "no power\n";
