#!/usr/bin/perl
use strict;
use warnings;
use Test::More tests => 2;
ok( 1, 'first' );
subtest 'inner' => sub {
    ok( 1, 'second' );
    sleep 1000;
};
