#!/usr/bin/perl
use strict;
use warnings;
use Test::More tests => 3;
ok( 1, 'first' );
subtest 'inner' => sub {
    ok( 1, 'second' );
    kill 'SEGV', $$;
    sleep 5;
};
