# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# A JDK of the system, and the console launcher and JUnit 4 from Maven's repository.
: "${source:?}" "${out:?}"
if ! have javac || ! have jar; then
  need_packages default-jdk-headless
fi
have mvn || need_packages maven

launcher=$HOME/.m2/repository/org/junit/platform/junit-platform-console-standalone/6.1.0/junit-platform-console-standalone-6.1.0.jar
junit4=$HOME/.m2/repository/junit/junit/4.13.2/junit-4.13.2.jar
hamcrest=$HOME/.m2/repository/org/hamcrest/hamcrest-core/1.3/hamcrest-core-1.3.jar
[ -e "$launcher" ] ||
  quietly mvn --batch-mode dependency:get -Dartifact=org.junit.platform:junit-platform-console-standalone:6.1.0
if [ ! -e "$junit4" ] || [ ! -e "$hamcrest" ]; then
  quietly mvn --batch-mode dependency:get -Dartifact=junit:junit:4.13.2
fi

# The corpus is a JAR that refers to JUnit 4, and a directory, as Maven and Gradle have one.
if [ ! "$out/corpus.jar" -nt "$source/build.sh" ] || [ -n "$(find "$source/example" -newer "$out/corpus.jar")" ]; then
  rm -rf "$out/classes" "$out/empty"
  mkdir -p "$out/classes" "$out/empty"
  quietly javac -nowarn -d "$out/classes" -cp "$launcher:$junit4:$hamcrest" "$source"/example/*.java
  cp "$junit4" "$hamcrest" "$out/"
  printf 'Class-Path: %s %s\n' "$(basename "$junit4")" "$(basename "$hamcrest")" >"$out/manifest"
  quietly jar --create --file "$out/corpus.jar" --manifest "$out/manifest" -C "$out/classes" .
  quietly jar --create --file "$out/empty.jar" -C "$out/empty" .
fi
for package in promises descendants; do
  class=${package^}Test
  if [ "$source/$package/$class.java" -nt "$out/$package/$package/$class.class" ]; then
    quietly javac -d "$out/$package" -cp "$launcher" "$source/$package/$class.java"
  fi
done

# Each case may start a virtual machine, which mostly loads and compiles the launcher. With an archive of its classes
# and the fast compiler, it takes less than half of the processor time. An archive that does not match is ignored,
# without a message.
PATH=${PATH//"$out/bin:"/}
java=$(readlink -f "$(type -P java)")
archive=$out/launcher.jsa
if [ "$source/build.sh" -nt "$archive" ] || [ "$java" -nt "$archive" ] || [ "$launcher" -nt "$archive" ]; then
  report=$(mktemp -d)
  PROMISE=true quietly "$java" "-XX:ArchiveClassesAtExit=$archive" -XX:+UseSerialGC -jar "$launcher" execute \
    --details=none --config=junit.platform.reporting.open.xml.enabled=true \
    "--config=junit.platform.reporting.output.dir=$report" \
    "--class-path=$out/promises" "--scan-class-path=$out/promises"
  rm -rf "$report"
  mkdir -p "$out/bin"
  options='-Xlog:cds=off -Xlog:cds+dynamic=off -XX:TieredStopAtLevel=1 -XX:+UseSerialGC "$@"'
  printf '#!/bin/sh\nexec %q -XX:SharedArchiveFile=%q %s\n' "$java" "$archive" "$options" >"$out/bin/java"
  chmod +x "$out/bin/java"
fi
setting PATH "$out/bin:$PATH"
setting RTF_JUNIT "$launcher"
