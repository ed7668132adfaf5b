# Reads the lists of mutants. README.md says what a list looks like.
#
#   perl mutants.pl names LIST...              each mutant: name, description
#   perl mutants.pl tests LIST...              each mutant: name, first, also, on
#   perl mutants.pl check ROOT LIST...         fails if one does not fit, or if
#                                              they are too many
#   perl mutants.pl apply ROOT NAME LIST...    changes the sources under ROOT,
#                                              and prints the changed files
use strict;
use warnings;

# All of them run in an hour.
my $most = 100;

# All mutants, in order: name, description, first, also, on, hunks of [file,
# old, new].
sub read_lists {
  my @mutants;
  my %seen;
  for my $list (@_) {
    my $first = 'none';
    open(my $in, '<', $list) or die "mutants: cannot read $list: $!\n";
    while (my $line = <$in>) {
      chomp $line;
      my $where = "mutants: $list:$.";
      next if $line =~ /^\s*(#|$)/;
      if ($line =~ /^mutant (\w+): (.+)$/) {
        die "$where: the name $1 is taken\n" if $seen{$1}++;
        push @mutants, {name => $1, what => $2, first => $first, also => 'none',
                        on => 'any', hunks => []};
        next;
      }
      if ($line =~ /^first (\S+)$/) {
        $first = $1;
        next;
      }
      my $mutant = $mutants[-1] or die "$where: expected \"mutant NAME: \"\n";
      my $hunk = $mutant->{hunks}[-1];
      if ($line =~ /^in (\S+)$/) {
        push @{$mutant->{hunks}}, [$1, '', ''];
      } elsif ($line =~ /^also (\S+)$/) {
        $mutant->{also} = $1;
      } elsif ($line =~ /^on (\S+)$/) {
        $mutant->{on} = $1;
      } elsif ($hunk && $line =~ /^([-+])(.*)$/) {
        $hunk->[$1 eq '-' ? 1 : 2] .= "$2\n";
      } else {
        die "$where: expected mutant, in, also, on, - or +, got \"$line\"\n";
      }
    }
  }
  return @mutants;
}

# The sources with the mutant in them, by file name. White space in the old text
# stands for any, so that a mutant survives the formatter.
sub mutate {
  my ($root, $mutant) = @_;
  my %text;
  my $stale = "mutants: refresh the mutant $mutant->{name}";
  die "$stale: it changes nothing\n" unless @{$mutant->{hunks}};
  for my $hunk (@{$mutant->{hunks}}) {
    my ($file, $old, $new) = @$hunk;
    if (!exists $text{$file}) {
      open(my $in, '<', "$root/$file") or die "$stale: no file $file\n";
      local $/;
      $text{$file} = <$in>;
    }
    my $pattern = join '\s+', map { quotemeta } split ' ', $old;
    die "$stale: it has no old text in $file\n" if $pattern eq '';
    my $count = () = $text{$file} =~ /$pattern/g;
    die "$stale: its old text occurs $count times in $file, not once\n"
      if $count != 1;
    $new =~ s/^\s+|\s+$//g;
    my $before = $text{$file};
    $text{$file} =~ s/$pattern/$new/;
    die "$stale: old and new text are the same\n" if $before eq $text{$file};
  }
  return %text;
}

my $command = shift @ARGV // '';
if ($command eq 'names') {
  print "$_->{name}\t$_->{what}\n" for read_lists(@ARGV);
} elsif ($command eq 'tests') {
  print "$_->{name}\t$_->{first}\t$_->{also}\t$_->{on}\n" for read_lists(@ARGV);
} elsif ($command eq 'check') {
  my $root = shift @ARGV;
  my @stale;
  my @mutants = read_lists(@ARGV);
  for my $mutant (@mutants) {
    push @stale, $@ unless eval { mutate($root, $mutant); 1 };
  }
  push @stale, "mutants: " . @mutants . " are more than $most: drop those that " .
    "repeat others\n" if @mutants > $most;
  die @stale if @stale;
} elsif ($command eq 'apply') {
  my ($root, $name, @lists) = @ARGV;
  my ($mutant) = grep { $_->{name} eq $name } read_lists(@lists);
  die "mutants: there is no mutant $name\n" unless $mutant;
  my %text = mutate($root, $mutant);
  for my $file (sort keys %text) {
    open(my $out, '>', "$root/$file") or die "mutants: cannot write $file: $!\n";
    print $out $text{$file};
    close $out or die "mutants: cannot write $file: $!\n";
    print "$file\n";
  }
} else {
  die "usage: perl mutants.pl names|tests|check|apply ...\n";
}
