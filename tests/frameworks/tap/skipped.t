#!/usr/bin/perl
use strict;
use warnings;
use Test::More skip_all => 'no robot here';
