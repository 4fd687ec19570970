#!/bin/bash
# Makes what the Zenoh configurations name: an authority of your own in FOLDER (kept if it is there already), and for each
# HOST a folder FOLDER/HOST with ca.pem, certificate.pem and key.pem, to be put in /etc/hingewise/tls on that host.
# HOST is the name or IPv4 address by which others reach it; it is also the certificate's common name, by which
# access_control knows it. worker:NAME makes a certificate that can only connect, in FOLDER/NAME: who steals it cannot
# pose as a coordinator, whatever name workers connect to. FOLDER/ca.key signs all of them: keep it to yourself.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: certificates.sh FOLDER HOST|worker:NAME..." >&2
    exit 2
fi
folder=$1
shift
days=825
for given in "$@"; do
    if ! [[ ${given#worker:} =~ ^[A-Za-z0-9][A-Za-z0-9._-]*$ ]]; then
        echo "certificates.sh: $given: allowed: letters, digits, . _ and -, with worker: before it or not" >&2
        exit 2
    fi
done
umask 077
mkdir -p "$folder"
new_key=(-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes)

if [ ! -e "$folder/ca.key" ]; then
    openssl req -x509 "${new_key[@]}" -keyout "$folder/ca.key" -out "$folder/ca.pem" -days 3650 \
        -subj "/CN=Hingewise authority" \
        -addext "basicConstraints=critical,CA:TRUE" -addext "keyUsage=critical,keyCertSign,cRLSign" 2>/dev/null
fi

for given in "$@"; do
    host=${given#worker:}
    own=$folder/$host
    mkdir -p "$own"
    kind=DNS
    [[ $host =~ ^[0-9.]+$ ]] && kind=IP
    use=serverAuth,clientAuth
    [[ $given == worker:* ]] && use=clientAuth
    openssl req -new "${new_key[@]}" -keyout "$own/key.pem" -out "$own/request.pem" -subj "/CN=$host" 2>/dev/null
    extensions="subjectAltName=$kind:$host
basicConstraints=critical,CA:FALSE
keyUsage=critical,digitalSignature
extendedKeyUsage=$use"
    openssl x509 -req -in "$own/request.pem" -CA "$folder/ca.pem" -CAkey "$folder/ca.key" -CAcreateserial \
        -days "$days" -out "$own/certificate.pem" -extfile <(printf '%s\n' "$extensions") 2>/dev/null
    rm "$own/request.pem"
    cp "$folder/ca.pem" "$own/ca.pem"
    echo "$own"
done
